#pragma once

#include <cstdint>
#include <vector>

#include "skin/pose.h"

namespace toile::skin {

enum class Split : std::int8_t { train = 0, validation = 1, test = 2 };

struct SplitOptions {
    std::uint64_t seed = 0;
    double validation_share = 0.1;  ///< of the poses, 0 to 1
    double test_share = 0.1;        ///< of the poses, 0 to 1; both together at most 1
    double duplicate_angle = 0.05;  ///< poses nearer than this in every joint stay in one split [rad], 0 to pi
};

struct PoseSplits {
    std::vector<Split> split;  ///< of each pose
    int clusters = 0;          ///< groups of near-duplicates, each within one split
    int largest_cluster = 0;   ///< its number of poses; it bounds how well the shares can be met
};

/// Assigns clusters of near-duplicate poses (`cluster_poses`) to splits. A seeded hash of the pose numbers orders the
/// clusters, so the result depends on poses, numbers and options alone and not on the order of the poses. Shares are
/// met as well as whole clusters allow, and every split with a positive share (train included) gets a cluster as long
/// as there are enough of them. `number` `[N]` names the poses; no two are equal.
PoseSplits split_poses(const std::vector<Pose>& pose, const std::vector<std::int64_t>& number,
                       const SplitOptions& options);

}  // namespace toile::skin
