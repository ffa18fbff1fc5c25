#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "evaluate/pose_features.h"

namespace toile::evaluate {
namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();

skin::Pose pose_of(std::initializer_list<double> angle) {
    skin::Pose pose(static_cast<Eigen::Index>(angle.size() / 3), 3);
    std::copy(angle.begin(), angle.end(), pose.data());
    return pose;
}

TEST(PoseFeatures, AreRotationMatricesLessTheIdentity) {
    const skin::Pose pose = pose_of({0, 0, 0, 0, 0, std::numbers::pi / 2});
    EXPECT_EQ(rotation_features(pose, {0}), Eigen::VectorXd::Zero(9));
    Eigen::VectorXd quarter(9);
    quarter << -1, -1, 0, 1, -1, 0, 0, 0, 0;
    EXPECT_LT((rotation_features(pose, {1}) - quarter).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(rotation_features(pose, {1, 0}).size(), 18);
    EXPECT_EQ(rotation_features(pose, {}).size(), 0);
}

TEST(PoseFeatures, JointsThatNeverTurnAreLeftOut) {
    JointRange range;
    range.add(pose_of({0.5, 0, 0, 1, 2, 3, 0, 0, 0}));
    EXPECT_TRUE(range.varying().empty());
    range.add(pose_of({0.5, 1e-10, 0, 1, 2.1, 3, 0, 0, 0}));
    range.add(pose_of({0.5, 0, 0, 1, 2, 3, 0, 0, -1e-3}));
    EXPECT_EQ(range.varying(), (std::vector<int>{1, 2}));
    EXPECT_TRUE(JointRange().varying().empty());
}

TEST(PoseDistance, IsTheSumOfSquaredAngles) {
    const auto distance = [](const skin::Pose& a, const skin::Pose& b) {
        return squared_pose_distance(joint_rotations(a, {0, 1}), joint_rotations(b, {0, 1}), no_bound);
    };
    const skin::Pose rest = pose_of({0, 0, 0, 0, 0, 0});
    EXPECT_NEAR(distance(rest, pose_of({0.3, 0, 0, 0, 0.4, 0})), 0.25, 1e-14);
    EXPECT_NEAR(distance(pose_of({0, 1.0, 0, 0, 0, 0}), pose_of({0, 1.5, 0, 0, 0, 2})), 4.25, 1e-13);
    EXPECT_NEAR(distance(rest, pose_of({1e-9, 0, 0, 0, 0, 0})), 1e-18, 1e-24);
    EXPECT_EQ(distance(pose_of({0.1, 0.2, 0.3, 1, 2, 0}), pose_of({0.1, 0.2, 0.3, 1, 2, 0})), 0);
    // a turn by more than half is a turn the other way
    EXPECT_NEAR(distance(rest, pose_of({2 * std::numbers::pi - 0.2, 0, 0, 0, 0, 0})), 0.04, 1e-13);
    EXPECT_NEAR(distance(pose_of({3, 0, 0, 0, 0, 0}), pose_of({-3, 0, 0, 0, 0, 0})),
                std::pow(2 * std::numbers::pi - 6, 2), 1e-13);
}

TEST(PoseDistance, StopsBeyondTheBound) {
    const auto a = joint_rotations(pose_of({0, 0, 0, 0, 0, 0}), {0, 1});
    const auto b = joint_rotations(pose_of({1, 0, 0, 1, 0, 0}), {0, 1});
    EXPECT_NEAR(squared_pose_distance(a, b, 0.5), 1, 1e-14);
    EXPECT_NEAR(squared_pose_distance(a, b, 5), 2, 1e-14);
}

}  // namespace
}  // namespace toile::evaluate
