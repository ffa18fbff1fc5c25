#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "skin/body.h"
#include "skin/pose.h"
#include "skin/pose_sampler.h"
#include "skin/pose_split.h"

namespace toile::skin {

/// Where poses come from. A pose depends on the source's options and its number alone.
class PoseSource {
  public:
    virtual ~PoseSource() = default;
    virtual std::int64_t count() const = 0;
    virtual Pose pose(std::int64_t number) const = 0;  ///< throws Error unless 0 <= number < count()

    /// The splits of the poses with these numbers, in their order. A pose's split does not depend on which others are
    /// asked for.
    virtual PoseSplits splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const = 0;
    PoseSplits splits(const SplitOptions& options) const;  ///< of all poses
};

/// Poses kept in memory: those of a motion or a table.
///
/// Splits keep the clusters of the whole list together (`cluster_poses`), so none leaks. A cluster's place in the
/// `SplitSequence` is the number of groups founded before its first pose (`PoseGroups`); one of more than eight poses
/// that is a larger part of the list than its split should be trains. Poses added at the end keep the splits of those
/// before, but for clusters they join to one, and clusters that their growth lets past that bound.
class PoseList : public PoseSource {
  public:
    explicit PoseList(std::vector<Pose> pose) : pose_(std::move(pose)) {}
    std::int64_t count() const override { return static_cast<std::int64_t>(pose_.size()); }
    Pose pose(std::int64_t number) const override;
    using PoseSource::splits;
    PoseSplits splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const override;

  private:
    std::vector<Pose> pose_;
};

/// The first `count` poses of a sampler.
///
/// Splits are those of the `PoseGroups` of all poses up to the largest number, so that `count` can grow. In a dense
/// sampling poses near two groups of different splits cannot be helped: `PoseSplits::conflicts`.
class SampledPoses : public PoseSource {
  public:
    SampledPoses(PoseSampler sampler, std::int64_t count);
    std::int64_t count() const override { return count_; }
    Pose pose(std::int64_t number) const override;
    using PoseSource::splits;
    PoseSplits splits(const std::vector<std::int64_t>& number, const SplitOptions& options) const override;

  private:
    PoseSampler sampler_;
    std::int64_t count_;
};

/// Which poses of a source are wanted.
struct PoseSelection {
    std::vector<std::int64_t> number;  ///< these, in this order; empty: all of them
    std::optional<std::int64_t> most;  ///< and of those the first so many, 1 or more
};

/// The numbers of the poses wanted. Throws Error for a number outside the source or listed twice, and for `most` below
/// one; `where` is the configuration's file and key.
std::vector<std::int64_t> selected_numbers(const PoseSource& source, const PoseSelection& selection,
                                           const std::string& where = {});

}  // namespace toile::skin
