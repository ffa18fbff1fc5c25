#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "skin/pose.h"

namespace toile::skin {

enum class Split : std::int8_t { train = 0, validation = 1, test = 2 };

struct SplitOptions {
    std::uint64_t seed = 0;
    double validation_share = 0.1;  ///< of the groups of poses, 0 to 1
    double test_share = 0.1;        ///< of the groups of poses, 0 to 1; both together at most 1
    double duplicate_angle = 0.05;  ///< poses nearer than this in every joint stay in one split [rad], 0 to pi
};

/// The splits of groups of poses, counted from 0 in the order in which their first poses come: a function of the
/// options and that count alone, so that what comes later changes nothing.
///
/// Groups are taken in blocks of as many as the smallest positive share asks for (ten at 0.1, at most 4096). A block's
/// groups have evenly spaced places in [0, 1), dealt out by a seeded shuffle; train is below 1 - validation - test, the
/// others follow. So every whole block has all three splits, the first one at the start, and any number of groups
/// meets the shares to within a block. The shuffle keeps the places from keeping step with the Sobol sequence of
/// `PoseSampler`, which a mere rotation of the places does not. Group 0 trains unless nothing does.
class SplitSequence {
  public:
    explicit SplitSequence(const SplitOptions& options);  ///< throws Error naming the option out of its range
    Split operator()(std::int64_t group);
    int block_size() const { return block_size_; }

  private:
    Split at(double place) const;
    void deal(std::int64_t block);
    SplitOptions options_;
    int block_size_ = 1;
    std::int64_t dealt_ = -1;   ///< the block whose splits are at hand
    std::vector<Split> split_;  ///< `[block_size]`
};

struct PoseSplits {
    std::vector<Split> split;           ///< of each pose asked for
    std::int64_t groups = 0;            ///< of near-duplicates, each within one split
    std::int64_t largest = 0;           ///< poses of the largest group
    std::int64_t conflicts = 0;         ///< poses that lie nearer than `duplicate_angle` to one of another split
    std::int64_t first = -1;            ///< the number of the first of these
    std::vector<int> size = {0, 0, 0};  ///< poses of each split
};

/// What a user should know about the splits, one sentence each: a split without samples, near poses that could not be
/// kept together.
std::vector<std::string> split_remarks(const PoseSplits& splits, const SplitOptions& options);

}  // namespace toile::skin
