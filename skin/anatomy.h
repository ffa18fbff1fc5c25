#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>

#include "skin/body.h"
#include "skin/pose.h"

namespace toile::skin {

/// Rig-independent joint angles. For each role three angles (raise, swing, twist) [rad], measured so that the same
/// numbers mean the same posture on every body, whatever its bind pose and its joints' axes. Left and right mirror each
/// other: equal numbers are a symmetric posture. The rotation is raise after swing after twist.
///
/// - Upper arms are measured from the T pose, relative to the chest: raise turns the arm up (+pi/2 straight overhead,
///   -pi/2 hanging down), swing brings it forward (+pi/2 straight ahead), twist turns it about its own bone. The bone's
///   direction relative to the chest is (cos raise cos swing, sin raise cos swing, sin swing) along (outwards, up,
///   forward), whatever the clavicle does.
/// - Lower arms are measured from the straight arm, relative to the upper arm as it is in the T pose: swing bends the
///   elbow forward, raise bends it up, twist turns the forearm.
/// - Hands are measured from the bind pose about the axes of the lower arm in the T pose.
/// - Clavicles are measured from the bind pose: raise lifts the shoulder, swing brings it forward.
/// - Every other role is measured from the bind pose about the body's axes: raise about the forward axis (towards the
///   body's left for the trunk, outwards for legs), swing about the side axis (bending or swinging forward positive, so
///   a knee bends by a negative swing), twist about the vertical axis (trunk to the left, legs outwards).
///
/// A clavicle that is not named moves with its arm as in people (scapulo-humeral rhythm, Inman et al. 1944): above the
/// horizontal a third of the arm's raise, setting in smoothly, is the clavicle's, and the upper arm's own joint makes
/// up the difference.
struct RoleAngles {
    std::map<Role, Eigen::Vector3d> angle;  ///< roles that are absent keep the bind pose
};

/// The pose with these angles. Throws Error where the body lacks a role that is named, or an angle is not finite.
Pose pose_from_angles(const Body& body, const RoleAngles& angles);

/// The angles (raise, swing, twist) of `role` in the bind pose: where a path from the neutral pose starts. Throws Error
/// where the body lacks the role.
Eigen::Vector3d bind_angles(const Body& body, Role role);

/// Limits (lower, upper) [rad] for each of raise, swing and twist.
struct JointLimit {
    Eigen::Vector3d lower;
    Eigen::Vector3d upper;
};
JointLimit default_limit(Role role);

/// Throws Error naming role and axis where a limit is not finite, reversed, or beyond a turn either way.
void check_limit(Role role, const JointLimit& limit, const std::string& where);

}  // namespace toile::skin
