#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloth/types.h"
#include "skin/body.h"

namespace toile::skin {

/// Joint rotations θ `[J x 3]`, axis-angle in each joint's own bind frame [rad]; zero is the bind pose. The root's
/// translation is fixed.
using Pose = Positions;

/// World transforms G_j of the joints: G_j = G_parent (B_parent^-1 B_j) R(θ_j), and G = B R(θ) for the root
/// (contract, `/samples/pose`).
std::vector<Eigen::Matrix4d> forward_kinematics(const Body& body, const Pose& pose);

/// Skinning transforms G_j B_j^-1, which carry bind-pose world positions to posed world positions.
std::vector<Eigen::Matrix4d> skinning_transforms(const Body& body, const Pose& pose);

/// The pose a share `t` in [0, 1] of the way from `from` to `to`: each joint's rotation follows the sphere's geodesic.
Pose interpolate(const Pose& from, const Pose& to, double t);

/// The largest rotation of any joint between two poses [rad].
double largest_joint_rotation(const Pose& from, const Pose& to);

}  // namespace toile::skin
