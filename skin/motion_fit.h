#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "files/motion_file.h"
#include "skin/body.h"

namespace toile::skin {

/// How a motion's skeleton is read. Everything can be found out from its names and its rest pose.
struct MotionFitOptions {
    std::string up = "auto";            ///< axis of the rest skeleton that points up: auto, x, y, z, -x, -y or -z
    double metres_per_unit = 0;         ///< length of one unit [m]; 0: found out from the body's size
    std::map<Role, std::string> joint;  ///< joint names for roles; the others are detected from common names
};

/// What carries a motion over to a body, role by role. A limb's bind bone and the motion's rest bone need not point the
/// same way (A pose and T pose): `align` is the smallest rotation, from the shoulder or hip outwards, that takes the
/// first to the second. Trunk, head and clavicles are taken to stand alike in both. With R the motion's global rotation
/// relative to its rest pose and W its axes in the body's, the body's joint turns, relative to its bind pose and seen
/// from the pelvis, by W (R_pelvis^-1 R_source) W^-1 align.
struct MotionFit {
    struct Link {
        int body_joint;
        int source;  ///< motion joint that ends the role's bone: rotations between two roles accumulate
        Eigen::Matrix3d align;
    };
    std::vector<Link> link;
    int pelvis = -1;                   ///< joint of the motion
    RoleMap role;                      ///< of the motion
    Eigen::Matrix3d axes;              ///< W: rows are the motion's left, up and forward
    double metres_per_unit = 0;        ///< given, or that which gives both the same trunk and legs
    std::vector<std::string> remarks;  ///< what was found out or is missing, one sentence each
};

/// Which joint of the motion does what: the joints given, the others by their names. Throws Error at `where` for a role
/// given to a joint that is absent or whose name is not unique.
RoleMap motion_roles(const files::Motion& motion, const MotionFitOptions& options, const std::string& where);

/// Throws Error at `where` (the motion's file): a role given to a joint that is absent or whose name is not unique; no
/// pelvis; no role in common with the body; a rest skeleton that does not tell up or left; an unknown axis, or one that
/// is across the way from pelvis to head; a unit that is negative or makes the skeleton no size for a person.
MotionFit fit_motion(const Body& body, const files::Motion& motion, const MotionFitOptions& options,
                     const std::string& where);

}  // namespace toile::skin
