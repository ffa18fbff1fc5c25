#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "files/motion_file.h"

namespace toile::skin::testing_support {

/// A person in a T pose with CMU's names, one unit a decimetre; two joints between pelvis and chest and a forearm cut
/// in two. `axes` turns the y-up, +z-facing skeleton and its motion into other world axes. All frames are the rest
/// pose.
inline files::Motion t_pose_motion(int frames, const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity()) {
    struct Stick {
        const char* name;
        int parent;
        Eigen::Vector3d offset;
    };
    const std::vector<Stick> sticks = {
        {"Hips", -1, {3, 9, 1}},
        {"LowerBack", 0, {0, 1, 0}},
        {"Spine", 1, {0, 1, 0}},
        {"Spine1", 2, {0, 1.5, 0}},
        {"Neck", 3, {0, 2, 0}},
        {"Head", 4, {0, 1, 0.1}},
        {"LeftShoulder", 3, {0.3, 1.5, 0}},
        {"LeftArm", 6, {1.5, 0, 0}},
        {"LeftForeArm", 7, {2.8, 0, 0}},
        {"LeftForeArmTwist", 8, {1.3, 0, 0}},
        {"LeftHand", 9, {1.2, 0, 0}},
        {"RightShoulder", 3, {-0.3, 1.5, 0}},
        {"RightArm", 11, {-1.5, 0, 0}},
        {"RightForeArm", 12, {-2.8, 0, 0}},
        {"RightForeArmTwist", 13, {-1.3, 0, 0}},
        {"RightHand", 14, {-1.2, 0, 0}},
        {"LeftUpLeg", 0, {0.9, -0.5, 0}},
        {"LeftLeg", 16, {0.3, -4.2, 0}},
        {"LeftFoot", 17, {0, -4, -0.3}},
        {"RightUpLeg", 0, {-0.9, -0.5, 0}},
        {"RightLeg", 19, {-0.3, -4.2, 0}},
        {"RightFoot", 20, {0, -4, -0.3}},
    };
    files::Motion motion;
    const auto joints = static_cast<Eigen::Index>(sticks.size());
    motion.rest_offset.resize(joints, 3);
    motion.end_offset = Positions::Zero(joints, 3);
    for (Eigen::Index j = 0; j < joints; ++j) {
        motion.joint_name.emplace_back(sticks[j].name);
        motion.joint_parent.push_back(sticks[j].parent);
        motion.rest_offset.row(j) = (axes * sticks[j].offset).transpose();
    }
    motion.frame_count = frames;
    motion.frame_time = 0.1;
    motion.rotation.assign(static_cast<std::size_t>(frames) * sticks.size(), Eigen::Quaterniond::Identity());
    motion.root_translation = Positions::Zero(frames, 3);
    return motion;
}

inline int joint_named(const files::Motion& motion, const std::string& name) {
    for (int j = 0; j < motion.joint_count(); ++j)
        if (motion.joint_name[j] == name) return j;
    return -1;
}

/// Sets a joint's local rotation, given in the axes of the y-up person.
inline void turn(files::Motion& motion, int frame, const std::string& name, const Eigen::Vector3d& axis_angle,
                 const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity()) {
    const double angle = axis_angle.norm();
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(axis_angle / angle) : Eigen::Vector3d::UnitX())
            .toRotationMatrix();
    motion.rotation[static_cast<std::size_t>(frame) * motion.joint_name.size() + joint_named(motion, name)] =
        Eigen::Quaterniond(Eigen::Matrix3d(axes * rotation * axes.transpose()));
}

}  // namespace toile::skin::testing_support
