#include <gtest/gtest.h>

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

TEST(PoseSource, SplitsItsPoses) {
    const PoseSplits splits = five_poses().splits({4, 1}, {});
    EXPECT_EQ(splits.split.size(), 2u);
    EXPECT_EQ(splits.clusters, 2);
    EXPECT_EQ(five_poses().splits(SplitOptions{}).split.size(), 5u);
}

}  // namespace
}  // namespace toile::skin
