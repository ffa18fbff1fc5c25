#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "skin/pose.h"
#include "tests/skin/two_bones.h"

namespace toile::skin {
namespace {

using testing_support::two_bones;

Eigen::Matrix4d rotation(const Eigen::Vector3d& axis_angle) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = Eigen::AngleAxisd(axis_angle.norm(), axis_angle.normalized()).toRotationMatrix();
    return m;
}

TEST(ForwardKinematics, FollowsTheContract) {
    const Body body = two_bones();
    Pose pose(2, 3);
    pose << 0.3, -0.2, 0.9, -1.4, 0.5, 0.1;
    const auto world = forward_kinematics(body, pose);
    const Eigen::Matrix4d root = body.joint[0].bind * rotation(pose.row(0).transpose());
    const Eigen::Matrix4d tip =
        root * body.joint[0].bind.inverse() * body.joint[1].bind * rotation(pose.row(1).transpose());
    EXPECT_TRUE(world[0].isApprox(root, 1e-13));
    EXPECT_TRUE(world[1].isApprox(tip, 1e-13));
    const auto skinning = skinning_transforms(body, pose);
    EXPECT_TRUE(skinning[1].isApprox(tip * body.joint[1].bind.inverse(), 1e-13));
}

TEST(ForwardKinematics, ZeroIsTheBindPose) {
    const Body body = two_bones();
    const auto world = forward_kinematics(body, Pose::Zero(2, 3));
    for (int j = 0; j < 2; ++j) EXPECT_TRUE(world[j].isApprox(body.joint[j].bind, 1e-14));
}

TEST(ForwardKinematics, RefusesPosesThatDoNotFit) {
    const Body body = two_bones();
    EXPECT_THROW(forward_kinematics(body, Pose::Zero(3, 3)), Error);
    Pose pose = Pose::Zero(2, 3);
    pose(1, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(forward_kinematics(body, pose), Error);
}

TEST(Interpolate, FollowsTheGeodesic) {
    Pose from(2, 3), to(2, 3);
    from << 0.3, -0.2, 0.9, 0, 0, 0;
    to << -1.0, 0.7, 0.2, 0, 2, 0;
    EXPECT_TRUE(interpolate(from, to, 0).isApprox(from, 1e-13));
    EXPECT_TRUE(interpolate(from, to, 1).isApprox(to, 1e-13));
    const Pose half = interpolate(from, to, 0.5);
    EXPECT_NEAR(half(1, 1), 1.0, 1e-13);
    EXPECT_NEAR(largest_joint_rotation(from, half), largest_joint_rotation(half, to), 1e-12);
    EXPECT_NEAR(2 * largest_joint_rotation(from, half), largest_joint_rotation(from, to), 1e-12);
}

TEST(Interpolate, TakesTheShortWayThroughAHalfTurn) {
    Pose from(1, 3), to(1, 3);
    from << 0, 3.0, 0;
    to << 0, -3.0, 0;  // 0.28 rad apart, across pi
    EXPECT_NEAR(largest_joint_rotation(from, to), 2 * M_PI - 6, 1e-12);
    EXPECT_NEAR(std::abs(interpolate(from, to, 0.5)(0, 1)), M_PI, 1e-12);
}

TEST(LargestJointRotation, SeesTheLargestAndTheSmallest) {
    Pose from = Pose::Zero(3, 3), to = Pose::Zero(3, 3);
    to(1, 2) = 1e-9;
    EXPECT_NEAR(largest_joint_rotation(from, to), 1e-9, 1e-20);
    to(2, 0) = -0.5;
    EXPECT_NEAR(largest_joint_rotation(from, to), 0.5, 1e-14);
    EXPECT_THROW(largest_joint_rotation(from, Pose::Zero(2, 3)), Error);
}

}  // namespace
}  // namespace toile::skin
