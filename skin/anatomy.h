#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "skin/body.h"
#include "skin/pose.h"

namespace toile::skin {

/// Rig-independent joint angles. For each role three angles (raise, swing, twist) [rad], measured so that the same
/// numbers mean the same posture on every body, whatever its bind pose and its joints' axes:
///
/// - arms are measured from the T pose: raise turns the arm up (+pi/2 straight overhead, -pi/2 hanging down), swing
/// brings it
///   forward, twist turns it about its own bone;
/// - every other role is measured from the bind pose about the body's axes: raise about the forward axis (towards the
/// body's
///   left for the trunk, away from the body for legs), swing about the side axis (bending forward positive), twist
///   about the vertical or bone axis.
struct RoleAngles {
    std::map<Role, Eigen::Vector3d> angle;  ///< roles that are absent keep the bind pose
};

/// The pose with these angles. Throws Error where the body lacks a role that is named.
Pose pose_from_angles(const Body& body, const RoleAngles& angles);

/// The angles (raise, swing, twist) of `role` in the bind pose: where a path from the neutral pose starts.
Eigen::Vector3d bind_angles(const Body& body, Role role);

/// Limits (lower, upper) [rad] for each of raise, swing and twist.
struct JointLimit {
    Eigen::Vector3d lower;
    Eigen::Vector3d upper;
};
JointLimit default_limit(Role role);

}  // namespace toile::skin
