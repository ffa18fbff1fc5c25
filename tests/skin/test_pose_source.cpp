#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloth/error.h"
#include "skin/pose_source.h"
#include "tests/skin/stick_body.h"

namespace toile::skin {
namespace {

PoseList five_poses() {
    std::vector<Pose> pose;
    for (int k = 0; k < 5; ++k) pose.push_back(Pose::Constant(2, 3, 0.1 * k));
    return PoseList(pose);
}

TEST(PoseSource, ListsPosesByNumber) {
    const PoseList list = five_poses();
    EXPECT_EQ(list.count(), 5);
    EXPECT_DOUBLE_EQ(list.pose(4)(1, 2), 0.4);
    EXPECT_THROW(list.pose(5), Error);
    EXPECT_THROW(list.pose(-1), Error);
}

TEST(PoseSource, SamplerEndsAtItsCount) {
    const PoseSampler sampler(testing_support::stick_body(), {});
    const SampledPoses source(sampler, 3);
    EXPECT_EQ(source.count(), 3);
    EXPECT_EQ(source.pose(2), sampler.pose(2));
    EXPECT_THROW(source.pose(3), Error);
    EXPECT_THROW(SampledPoses(sampler, 0), Error);
}

TEST(PoseSource, SelectsByNumberAndCount) {
    const PoseList list = five_poses();
    EXPECT_EQ(selected_numbers(list, {}), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(selected_numbers(list, {{4, 0, 2}, {}}), (std::vector<std::int64_t>{4, 0, 2}));
    EXPECT_EQ(selected_numbers(list, {{4, 0, 2}, 2}), (std::vector<std::int64_t>{4, 0}));
    EXPECT_EQ(selected_numbers(list, {{}, 9}).size(), 5u);
    EXPECT_THROW(selected_numbers(list, {{5}, {}}), Error);
    EXPECT_THROW(selected_numbers(list, {{-1}, {}}), Error);
    EXPECT_THROW(selected_numbers(list, {{1, 1}, {}}), Error);
    EXPECT_THROW(selected_numbers(list, {{}, 0}), Error);
}

std::vector<std::int64_t> first_numbers(std::int64_t count) {
    std::vector<std::int64_t> number(static_cast<std::size_t>(count));
    std::iota(number.begin(), number.end(), 0);
    return number;
}

/// Clusters of the given sizes, 0.2 rad apart; poses within one are 0.01 rad apart.
PoseList clusters(const std::vector<int>& size) {
    std::vector<Pose> pose;
    for (std::size_t c = 0; c < size.size(); ++c)
        for (int i = 0; i < size[c]; ++i) {
            pose.push_back(Pose::Zero(40, 3));
            pose.back()(static_cast<Eigen::Index>(c % 40), 0) = 0.2 * static_cast<double>(1 + c / 40) + 0.01 * (i % 3);
        }
    return PoseList(pose);
}

TEST(PoseSource, SplitsOfASamplerDoNotChangeAsItGrows) {
    const PoseSampler sampler(testing_support::stick_body(), {});
    const PoseSplits all = SampledPoses(sampler, 2000).splits(SplitOptions{});
    EXPECT_EQ(all.groups, 2000);
    EXPECT_EQ(all.size, (std::vector<int>{1600, 200, 200}));
    for (const std::int64_t count : {12, 100}) {
        const PoseSplits fewer = SampledPoses(sampler, count).splits(SplitOptions{});
        EXPECT_TRUE(std::equal(fewer.split.begin(), fewer.split.end(), all.split.begin())) << count;
        for (const int size : fewer.size) EXPECT_GE(size, 1) << count;
    }
    EXPECT_EQ(SampledPoses(sampler, 2000).splits({7, 1999, 3}, {}).split,
              (std::vector<Split>{all.split[7], all.split[1999], all.split[3]}));
    SplitOptions other;
    other.seed = 1;
    EXPECT_NE(SampledPoses(sampler, 2000).splits(other).split, all.split);
}

TEST(PoseSource, NearPosesOfADenseSamplerAreCounted) {
    SamplerOptions options;
    options.roles = {Role::left_lower_arm};
    options.limits[Role::left_lower_arm] = {{0, 0, 0}, {0, 1.5, 0}};
    const PoseSampler sampler(testing_support::stick_body(), options);
    const SampledPoses source(sampler, 3000);
    const PoseSplits splits = source.splits(SplitOptions{});
    EXPECT_LE(splits.groups, 1.5 / 0.05 + 1);
    EXPECT_GT(splits.largest, 3000 / 40);
    // A pose counts only where one of another split is near.
    EXPECT_GT(splits.conflicts, 0);
    std::int64_t near = 0;
    for (int a = 0; a < 3000; ++a) {
        bool found = false;
        for (int b = 0; b < 3000 && !found; ++b)
            found = splits.split[a] != splits.split[b] &&
                    std::abs(sampler.angles(a).angle.at(Role::left_lower_arm)[1] -
                             sampler.angles(b).angle.at(Role::left_lower_arm)[1]) < 0.05;
        near += found;
    }
    EXPECT_LE(splits.conflicts, near);
    EXPECT_GE(splits.conflicts, near / 4);
    for (const std::int64_t count : {12, 100}) {
        const PoseSplits fewer = SampledPoses(sampler, count).splits(SplitOptions{});
        EXPECT_TRUE(std::equal(fewer.split.begin(), fewer.split.end(), splits.split.begin())) << count;
    }
}

TEST(PoseSource, SplitsOfAListKeepItsClustersWhateverIsSelected) {
    const PoseList list = clusters({1, 4, 2, 7, 1, 3, 5, 2, 1, 6, 3, 2, 1, 1, 2, 1, 1, 1, 1, 3});
    const PoseSplits all = list.splits(SplitOptions{});
    EXPECT_EQ(all.groups, 20);
    EXPECT_EQ(all.largest, 7);
    EXPECT_EQ(all.conflicts, 0);
    for (std::int64_t a = 0; a < list.count(); ++a)
        for (std::int64_t b = 0; b < a; ++b)
            if (largest_joint_rotation(list.pose(a), list.pose(b)) < 0.05) {
                EXPECT_EQ(all.split[a], all.split[b]);
            }
    for (const int size : all.size) EXPECT_GE(size, 1);
    for (const std::int64_t count : {1, 5, 20}) {
        const std::vector<Split> fewer = list.splits(first_numbers(count), {}).split;
        EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), all.split.begin())) << count;
    }
    EXPECT_EQ(list.splits({17, 2}, {}).split, (std::vector<Split>{all.split[17], all.split[2]}));
    EXPECT_THROW(list.splits({48}, {}), Error);
}

TEST(PoseSource, SplitsOfAListStayWhenPosesAreAddedAtItsEnd) {
    std::vector<int> size(40, 1);
    for (int c = 0; c < 40; c += 3) size[c] = 1 + c % 5;
    const PoseSplits before = clusters(size).splits(SplitOptions{});
    size.resize(60, 2);
    const PoseSplits after = clusters(size).splits(SplitOptions{});
    EXPECT_TRUE(std::equal(before.split.begin(), before.split.end(), after.split.begin()));
}

TEST(PoseSource, AClusterThatIsALargePartOfAListTrains) {
    EXPECT_EQ(clusters({50}).splits(SplitOptions{}).size, (std::vector<int>{50, 0, 0}));
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SplitOptions options;
        options.seed = seed;
        std::vector<int> size(20, 1);
        size[7] = 100;
        const PoseSplits splits = clusters(size).splits(options);
        EXPECT_EQ(splits.split[50], Split::train);
        EXPECT_LE(splits.size[1] + splits.size[2], 4);
    }
}

}  // namespace
}  // namespace toile::skin
