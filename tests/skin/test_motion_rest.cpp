#include <gtest/gtest.h>

#include <random>

#include "skin/motion_fit.h"
#include "skin/motion_poses.h"
#include "skin/motion_rest.h"
#include "tests/skin/stick_body.h"
#include "tests/skin/t_pose_motion.h"

namespace toile::skin {
namespace {

using testing_support::joint_named;
using testing_support::t_pose_motion;
using testing_support::turn;

std::vector<Eigen::Vector3d> joint_positions(const files::Motion& motion, int frame) {
    std::vector<Eigen::Vector3d> position;
    std::vector<Eigen::Quaterniond> rotation;
    for (int j = 0; j < motion.joint_count(); ++j) {
        const int parent = motion.joint_parent[j];
        const Eigen::Vector3d offset = motion.rest_offset.row(j).transpose();
        position.push_back(parent < 0 ? offset : Eigen::Vector3d(position[parent] + rotation[parent] * offset));
        rotation.push_back(parent < 0 ? motion.local_rotation(frame, j)
                                      : rotation[parent] * motion.local_rotation(frame, j));
    }
    return position;
}

/// The motion with every bone of the rest pose along +x, whatever its joint: only the rotations make it a person.
files::Motion bones_along_x(const files::Motion& motion) {
    files::Motion laid = motion;
    // A joint's own rotation Q turns +x to where its first child is.
    std::vector<Eigen::Quaterniond> bearing(motion.joint_name.size(), Eigen::Quaterniond::Identity());
    std::vector<bool> has_child(motion.joint_name.size(), false);
    for (int j = 1; j < motion.joint_count(); ++j) {
        const int parent = motion.joint_parent[j];
        if (has_child[parent]) continue;
        has_child[parent] = true;
        bearing[parent] = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(),
                                                             Eigen::Vector3d(motion.rest_offset.row(j).transpose()));
    }
    for (int j = 0; j < motion.joint_count(); ++j) {
        const int parent = motion.joint_parent[j];
        const Eigen::Quaterniond carrier = parent < 0 ? Eigen::Quaterniond::Identity() : bearing[parent];
        laid.rest_offset.row(j) = (carrier.conjugate() * motion.rest_offset.row(j).transpose()).transpose();
        for (int f = 0; f < motion.frame_count; ++f)
            laid.rotation[static_cast<std::size_t>(f) * motion.joint_name.size() + j] =
                carrier.conjugate() * motion.local_rotation(f, j) * bearing[j];
    }
    return laid;
}

files::Motion moving_person() {
    files::Motion motion = t_pose_motion(6);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> angle(-0.5, 0.5);
    for (int frame = 0; frame < motion.frame_count; ++frame) {
        if (frame == 2) continue;  // the T pose
        for (const std::string& name : motion.joint_name) {
            const double x = angle(random), y = angle(random), z = angle(random);
            turn(motion, frame, name, {x, y, z});
        }
        turn(motion, frame, "LeftLeg", {1.2, 0, 0});
    }
    return motion;
}

TEST(MotionRest, LeavesAStandingRestPoseAlone) {
    const files::Motion motion = moving_person();
    EXPECT_FALSE(standing_frame(motion, motion_roles(motion, {}, "")).has_value());
    files::Motion legless = motion;
    for (std::string& name : legless.joint_name)
        if (name.find("Leg") != std::string::npos || name.find("Foot") != std::string::npos) name = "tail";
    EXPECT_FALSE(standing_frame(legless, motion_roles(legless, {}, "")).has_value());
}

TEST(MotionRest, KeepsEveryFrameAsItIs) {
    const files::Motion motion = moving_person(), based = with_rest_frame(motion, 4);
    for (int frame = 0; frame < motion.frame_count; ++frame) {
        const auto expected = joint_positions(motion, frame), position = joint_positions(based, frame);
        for (std::size_t j = 0; j < position.size(); ++j) EXPECT_LT((position[j] - expected[j]).norm(), 1e-12);
    }
    for (int j = 0; j < motion.joint_count(); ++j)
        EXPECT_LT(based.local_rotation(4, j).angularDistance(Eigen::Quaterniond::Identity()), 1e-7);
}

TEST(MotionRest, FindsThePersonInRotationsAlone) {
    const files::Motion motion = moving_person(), laid = bones_along_x(motion);
    const RoleMap role = motion_roles(laid, {}, "");
    ASSERT_EQ(standing_frame(laid, role), 2);
    const files::Motion based = with_rest_frame(laid, 2);
    const Body body = testing_support::stick_body();
    const auto expected = motion_poses(body, motion, fit_motion(body, motion, {}, ""), {}, "");
    const auto pose = motion_poses(body, based, fit_motion(body, based, {}, ""), {}, "");
    for (std::size_t k = 0; k < pose.size(); ++k) EXPECT_LT(largest_joint_rotation(pose[k], expected[k]), 1e-6);
}

}  // namespace
}  // namespace toile::skin
