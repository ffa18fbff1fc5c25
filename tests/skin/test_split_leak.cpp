#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "skin/split_leak.h"

namespace toile::skin {
namespace {

std::vector<std::pair<std::int64_t, std::int64_t>> leaks(const std::vector<Pose>& pose,
                                                         const std::vector<std::int8_t>& split, double angle) {
    std::vector<std::pair<std::int64_t, std::int64_t>> found;
    for (const SplitLeak& one :
         split_leaks([&](std::int64_t k) { return pose[static_cast<std::size_t>(k)]; }, split, angle))
        found.emplace_back(one.pose, one.other);
    return found;
}

Pose at(double angle) {
    Pose pose = Pose::Zero(2, 3);
    pose(1, 0) = angle;
    return pose;
}

TEST(SplitLeak, NamesTheFirstNearPoseOfAnotherSplit) {
    const std::vector<Pose> pose{at(0), at(0.01), at(0.5), at(0.02), at(0.51)};
    using Found = std::vector<std::pair<std::int64_t, std::int64_t>>;
    EXPECT_EQ(leaks(pose, {0, 0, 0, 2, 0}, 0.05), (Found{{3, 0}}));
    EXPECT_EQ(leaks(pose, {0, 1, 0, 2, 1}, 0.05), (Found{{1, 0}, {3, 0}, {4, 2}}));
    EXPECT_EQ(leaks(pose, {0, 0, 1, 0, 1}, 0.05), Found{});
    EXPECT_EQ(leaks(pose, {0, 0, 0, 0, 0}, 0.05), Found{});
    EXPECT_EQ(leaks(pose, {0, 1, 0, 2, 1}, 0), Found{});
    EXPECT_EQ(leaks({}, {}, 0.05), Found{});
}

TEST(SplitLeak, PosesThatAreNotFiniteAreNearNothing) {
    const std::vector<Pose> pose{at(std::nan("")), at(0), at(std::nan("")), at(0)};
    EXPECT_EQ(leaks(pose, {0, 1, 0, 0}, 0.05), (std::vector<std::pair<std::int64_t, std::int64_t>>{{3, 1}}));
}

TEST(SplitLeak, AgreesWithComparingAllWithAll) {
    std::mt19937_64 random(2);
    for (const double range : {0.3, 1.0, 3.0}) {
        std::uniform_real_distribution<double> angle(-range, range);
        std::vector<Pose> pose;
        std::vector<std::int8_t> split;
        for (int k = 0; k < 500; ++k) {
            Pose one = Pose::Zero(5, 3);
            for (int joint = 1; joint < 4; ++joint) one.row(joint) << angle(random), 0.4 * angle(random), 0;
            pose.push_back(one);
            split.push_back(static_cast<std::int8_t>(random() % 3));
        }
        std::vector<std::pair<std::int64_t, std::int64_t>> expected;
        for (int k = 0; k < 500; ++k)
            for (int j = 0; j < k; ++j)
                if (split[j] != split[k] && largest_joint_rotation(pose[j], pose[k]) < 0.2) {
                    expected.emplace_back(k, j);
                    break;
                }
        EXPECT_EQ(leaks(pose, split, 0.2), expected) << range;
        if (range < 1) {
            EXPECT_GT(expected.size(), 100u);
        }
    }
}

}  // namespace
}  // namespace toile::skin
