#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "cloth/error.h"
#include "skin/pose_cluster.h"

namespace toile::skin {
namespace {

/// Single linkage by its definition: labels spread along near pairs until none changes.
std::vector<int> by_definition(const std::vector<Pose>& pose, double angle) {
    const int count = static_cast<int>(pose.size());
    std::vector<std::pair<int, int>> near;
    for (int a = 0; a < count; ++a)
        for (int b = 0; b < a; ++b)
            if (largest_joint_rotation(pose[a], pose[b]) < angle) near.emplace_back(a, b);
    std::vector<int> label(count);
    std::iota(label.begin(), label.end(), 0);
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b] : near) {
            const int least = std::min(label[a], label[b]);
            changed = changed || label[a] != label[b];
            label[a] = label[b] = least;
        }
    }
    return label;
}

/// Random walks from random starts, which give clusters of all sizes and shapes.
std::vector<Pose> walks(int count, int joints, double step, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(-1, 1);
    std::vector<Pose> pose;
    for (int k = 0; k < count; ++k) {
        Pose next = k % 17 == 0 || pose.empty() ? Pose(Pose::Zero(joints, 3)) : pose.back();
        for (int j = 0; j < joints; ++j)
            for (int i = 0; i < 3; ++i) next(j, i) += (k % 17 == 0 ? 0.3 : step) * share(random);
        pose.push_back(next);
    }
    std::shuffle(pose.begin(), pose.end(), random);
    return pose;
}

TEST(PoseCluster, AgreesWithItsDefinition) {
    for (const int joints : {1, 2, 7})
        for (const double step : {0.01, 0.05, 0.1}) {
            const std::vector<Pose> pose = walks(150, joints, step, 11);
            EXPECT_EQ(cluster_poses(pose, 0.08), by_definition(pose, 0.08)) << joints << " joints, step " << step;
        }
}

TEST(PoseCluster, JoinsRotationsAcrossAHalfTurn) {
    // Axis-angle jumps where a rotation passes pi, and 0 and 2 pi are one rotation.
    const auto pose = [](double x) {
        Pose p = Pose::Zero(1, 3);
        p(0, 0) = x;
        return p;
    };
    EXPECT_EQ(cluster_poses({pose(3.13), pose(-3.14), pose(0), pose(2 * M_PI - 0.01)}, 0.05),
              (std::vector<int>{0, 0, 2, 2}));
}

TEST(PoseCluster, ChainsJoinWhatIsFarApart) {
    std::vector<Pose> pose(100, Pose::Zero(3, 3));
    for (int k = 0; k < 100; ++k) pose[k](1, 2) = 0.02 * (k * 37 % 100) + (k * 37 % 100 >= 60 ? 0.1 : 0);
    const std::vector<int> label = cluster_poses(pose, 0.05);
    EXPECT_EQ(label, by_definition(pose, 0.05));
    EXPECT_EQ(std::count(label.begin(), label.end(), 0), 60);
}

TEST(PoseCluster, TakesThousandsOfEqualPosesInItsStride) {
    // A standstill of 40,000 frames: 800 million pairs if they were compared one by one.
    std::vector<Pose> pose(40000, Pose::Constant(4, 3, 0.2));
    pose.back()(2, 1) = 1.0;
    const std::vector<int> label = cluster_poses(pose, 0.05);
    EXPECT_EQ(std::count(label.begin(), label.end(), 0), 39999);
    EXPECT_EQ(label.back(), 39999);
}

TEST(PoseCluster, KnowsTheEdges) {
    EXPECT_TRUE(cluster_poses({}, 0.05).empty());
    const std::vector<Pose> equal(3, Pose::Zero(2, 3));
    EXPECT_EQ(cluster_poses(equal, 0), (std::vector<int>{0, 1, 2}));  // nothing is nearer than 0
    EXPECT_EQ(cluster_poses(equal, 1e-12), (std::vector<int>{0, 0, 0}));
    EXPECT_THROW(cluster_poses({Pose::Zero(2, 3), Pose::Zero(3, 3)}, 0.05), Error);
    EXPECT_THROW(cluster_poses({Pose::Constant(2, 3, std::numeric_limits<double>::quiet_NaN())}, 0.05), Error);
}

}  // namespace
}  // namespace toile::skin
