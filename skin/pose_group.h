#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "skin/pose.h"

namespace toile::skin {

/// Groups poses in their order, each by the poses before it alone: a pose joins the group of the first of those that
/// are nearer than `angle` in every joint, else it founds the next group. For a sequence that may grow.
///
/// Poses within angle/2 of an earlier one are not compared with later poses, so that a dense sequence costs
/// no more than a sparse one. Kept are a few numbers a pose (92 MB for a million), by which far poses are told apart;
/// poses that may be near are asked for again.
class PoseGroups {
  public:
    using Source = std::function<Pose(std::int64_t)>;

    /// `pose(k)` gives pose k, 0 <= k < count. `angle` [rad], 0: every pose is a group of its own.
    PoseGroups(Source pose, std::int64_t count, double angle);
    ~PoseGroups();

    struct Place {
        std::int64_t group = 0;          ///< counted from 0 in the order of founding
        bool founds = false;             ///< whether the pose is its first
        std::vector<std::int64_t> near;  ///< the groups of the kept poses that are near, in no order, with repeats
    };
    /// The group of the next pose: of pose 0 first. At most `count` calls.
    Place next();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::skin
