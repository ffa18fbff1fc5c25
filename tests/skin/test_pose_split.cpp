#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "cloth/error.h"
#include "skin/pose_split.h"

namespace toile::skin {
namespace {

Pose at(double angle) {
    Pose pose = Pose::Zero(2, 3);
    pose(1, 0) = angle;
    return pose;
}

/// Clusters of the given sizes, 0.2 rad apart; poses within one are 0.01 rad apart.
std::vector<Pose> clusters(const std::vector<int>& size) {
    std::vector<Pose> pose;
    for (std::size_t c = 0; c < size.size(); ++c)
        for (int i = 0; i < size[c]; ++i) pose.push_back(at(0.2 * static_cast<double>(c) + 0.01 * (i % 3)));
    return pose;
}

std::vector<std::int64_t> numbers(std::size_t count) {
    std::vector<std::int64_t> number(count);
    std::iota(number.begin(), number.end(), 0);
    return number;
}

std::map<Split, int> sizes(const PoseSplits& splits) {
    std::map<Split, int> size;
    for (const Split split : splits.split) ++size[split];
    return size;
}

TEST(PoseSplit, GivesEachOfTwelvePosesASplit) {
    const std::vector<Pose> pose = clusters(std::vector<int>(12, 1));
    std::set<std::vector<Split>> different;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SplitOptions options;
        options.seed = seed;
        const PoseSplits splits = split_poses(pose, numbers(12), options);
        EXPECT_EQ(splits.clusters, 12);
        EXPECT_EQ(sizes(splits), (std::map<Split, int>{{Split::train, 10}, {Split::validation, 1}, {Split::test, 1}}));
        different.insert(splits.split);
    }
    EXPECT_GT(different.size(), 10u);
}

TEST(PoseSplit, KeepsNearDuplicatesTogether) {
    const std::vector<int> size = {1, 4, 2, 7, 1, 3, 5, 2, 1, 6, 3, 2};
    const std::vector<Pose> pose = clusters(size);
    SplitOptions options;
    options.validation_share = 0.2;
    options.test_share = 0.25;
    const PoseSplits splits = split_poses(pose, numbers(pose.size()), options);
    EXPECT_EQ(splits.clusters, 12);
    EXPECT_EQ(splits.largest_cluster, 7);
    for (std::size_t a = 0; a < pose.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            if (largest_joint_rotation(pose[a], pose[b]) < options.duplicate_angle) {
                EXPECT_EQ(splits.split[a], splits.split[b]);
            }
    EXPECT_NEAR(sizes(splits)[Split::validation], 0.2 * 37, 1);
    EXPECT_NEAR(sizes(splits)[Split::test], 0.25 * 37, 1);
}

TEST(PoseSplit, DoesNotDependOnTheOrder) {
    const std::vector<Pose> pose = clusters({1, 4, 2, 7, 1, 3, 5, 2, 1, 6, 3, 2});
    const std::vector<std::int64_t> number = numbers(pose.size());
    const std::vector<Split> split = split_poses(pose, number, {}).split;
    std::vector<Pose> reversed(pose.rbegin(), pose.rend());
    std::vector<Split> back = split_poses(reversed, {number.rbegin(), number.rend()}, {}).split;
    std::reverse(back.begin(), back.end());
    EXPECT_EQ(back, split);
}

TEST(PoseSplit, NoSplitIsEmptyWhereClustersSuffice) {
    for (const auto& size : std::vector<std::vector<int>>{{100, 3, 50}, {1, 1, 1}, {30, 30, 30, 30}}) {
        const std::vector<Pose> pose = clusters(size);
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            SplitOptions options;
            options.seed = seed;
            options.validation_share = 0.01;
            options.test_share = 0.6;
            EXPECT_EQ(sizes(split_poses(pose, numbers(pose.size()), options)).size(), 3u) << size.front();
        }
    }
    // A large cluster is for training where the shares are small.
    EXPECT_EQ(split_poses(clusters({100, 3, 5}), numbers(108), {}).split.front(), Split::train);
}

TEST(PoseSplit, FewClustersTrainFirst) {
    const std::vector<Pose> one = clusters({5});
    EXPECT_EQ(split_poses(one, numbers(5), {}).split, std::vector<Split>(5, Split::train));
    const PoseSplits two = split_poses(clusters({2, 5}), numbers(7), {});
    EXPECT_EQ(two.split.front(), Split::test);
    EXPECT_EQ(two.split.back(), Split::train);
    EXPECT_TRUE(split_poses({}, {}, {}).split.empty());
}

TEST(PoseSplit, SharesOfNothingAndOfEverything) {
    SplitOptions options;
    options.validation_share = 0;
    options.test_share = 0;
    const std::vector<Pose> pose = clusters(std::vector<int>(10, 1));
    EXPECT_EQ(sizes(split_poses(pose, numbers(10), options)), (std::map<Split, int>{{Split::train, 10}}));
    options.test_share = 1;
    EXPECT_EQ(sizes(split_poses(pose, numbers(10), options)), (std::map<Split, int>{{Split::test, 10}}));
}

TEST(PoseSplit, RefusesOneDefectAtATime) {
    const std::vector<Pose> pose = clusters({1, 1, 1});
    SplitOptions options;
    EXPECT_NO_THROW(split_poses(pose, numbers(3), options));
    EXPECT_THROW(split_poses(pose, numbers(2), options), Error);
    options.test_share = 0.95;
    EXPECT_THROW(split_poses(pose, numbers(3), options), Error);
    options.test_share = -0.1;
    EXPECT_THROW(split_poses(pose, numbers(3), options), Error);
    options = {};
    options.duplicate_angle = 4;
    EXPECT_THROW(split_poses(pose, numbers(3), options), Error);
}

}  // namespace
}  // namespace toile::skin
