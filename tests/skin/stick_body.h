#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "skin/body.h"

namespace toile::skin::testing_support {

struct Stick {
    std::string name;
    int parent;
    Eigen::Vector3d position;  ///< [m]
    int role;                  ///< of Role, -1 for none
};

/// The joints of a humanoid in an A pose, without a surface; each bind frame is turned by its own odd rotation, as
/// rigs' are, unless `plain`.
inline Body stick_body(bool plain = false) {
    const auto as = [](Role role) { return static_cast<int>(role); };
    const std::vector<Stick> sticks = {
        {"pelvis", -1, {0, 1, 0}, as(Role::pelvis)},
        {"spine", 0, {0, 1.1, 0}, as(Role::spine)},
        {"chest", 1, {0, 1.3, 0}, as(Role::chest)},
        {"neck", 2, {0, 1.5, 0}, as(Role::neck)},
        {"head", 3, {0, 1.6, 0.02}, as(Role::head)},
        {"clavicle_l", 2, {0.03, 1.42, 0}, as(Role::left_clavicle)},
        {"upperarm_l", 5, {0.18, 1.42, 0}, as(Role::left_upper_arm)},
        {"lowerarm_l", 6, {0.38, 1.22, 0}, as(Role::left_lower_arm)},
        {"hand_l", 7, {0.55, 1.04, 0.03}, as(Role::left_hand)},
        {"finger_l", 8, {0.62, 0.97, 0.04}, -1},
        {"clavicle_r", 2, {-0.03, 1.42, 0}, as(Role::right_clavicle)},
        {"upperarm_r", 10, {-0.18, 1.42, 0}, as(Role::right_upper_arm)},
        {"lowerarm_r", 11, {-0.38, 1.22, 0}, as(Role::right_lower_arm)},
        {"hand_r", 12, {-0.55, 1.04, 0.03}, as(Role::right_hand)},
        {"finger_r", 13, {-0.62, 0.97, 0.04}, -1},
        {"thigh_l", 0, {0.09, 0.93, 0}, as(Role::left_upper_leg)},
        {"calf_l", 15, {0.1, 0.5, 0.01}, as(Role::left_lower_leg)},
        {"foot_l", 16, {0.1, 0.08, -0.02}, as(Role::left_foot)},
        {"thigh_r", 0, {-0.09, 0.93, 0}, as(Role::right_upper_leg)},
        {"calf_r", 18, {-0.1, 0.5, 0.01}, as(Role::right_lower_leg)},
        {"foot_r", 19, {-0.1, 0.08, -0.02}, as(Role::right_foot)},
    };
    Body body;
    for (const Stick& stick : sticks) {
        Joint joint;
        joint.name = stick.name;
        joint.parent = stick.parent;
        joint.bind.setIdentity();
        const int index = body.joint_count();
        if (!plain)
            joint.bind.topLeftCorner<3, 3>() =
                Eigen::AngleAxisd(0.7 * index, Eigen::Vector3d(1, 0.5 * index, -0.3).normalized()).toRotationMatrix();
        joint.bind.topRightCorner<3, 1>() = stick.position;
        if (stick.role >= 0) body.role.joint[stick.role] = index;
        body.joint.push_back(joint);
    }
    return body;
}

}  // namespace toile::skin::testing_support
