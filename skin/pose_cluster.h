#pragma once

#include <vector>

#include "skin/pose.h"

namespace toile::skin {

/// Single-linkage clusters of poses: two poses whose largest joint rotation (`largest_joint_rotation`) is below `angle`
/// [rad] are in one cluster, and so is whatever a chain of such pairs joins. Returns for each pose the smallest index
/// of its cluster `[N]`; the clusters do not depend on the order of the poses. Throws Error where the poses differ in
/// their number of joints or hold values that are not finite.
///
/// Poses within angle/2 of a leader are gathered first, so that a motion's standstills cost one comparison a frame;
/// leaders are then compared with those near them in a grid over the four joints that vary most. This takes
/// O(N J) plus the pairs of neighbours in the grid: about linear for motions and samplers, N^2 at worst, where poses
/// differ only in joints outside the grid.
std::vector<int> cluster_poses(const std::vector<Pose>& pose, double angle);

}  // namespace toile::skin
