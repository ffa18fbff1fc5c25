#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "skin/pose_group.h"

namespace toile::skin {
namespace {

Pose at(double angle) {
    Pose pose = Pose::Zero(2, 3);
    pose(1, 0) = angle;
    return pose;
}

std::vector<PoseGroups::Place> grouped(const std::vector<Pose>& pose, double angle) {
    PoseGroups groups([&](std::int64_t k) { return pose[static_cast<std::size_t>(k)]; },
                      static_cast<std::int64_t>(pose.size()), angle);
    std::vector<PoseGroups::Place> place;
    for (std::size_t k = 0; k < pose.size(); ++k) place.push_back(groups.next());
    return place;
}

/// The rule as the header states it, by comparing everything with everything.
std::vector<std::int64_t> expected(const std::vector<Pose>& pose, double angle) {
    std::vector<std::int64_t> group;
    std::vector<bool> kept;
    std::int64_t groups = 0;
    for (std::size_t k = 0; k < pose.size(); ++k) {
        std::int64_t joined = -1;
        double nearest = angle;
        for (std::size_t j = 0; j < k; ++j) {
            const double distance = largest_joint_rotation(pose[j], pose[k]);
            if (!kept[j] || distance >= angle) continue;
            if (joined < 0) joined = group[j];
            nearest = std::min(nearest, distance);
        }
        group.push_back(joined < 0 ? groups++ : joined);
        kept.push_back(nearest >= angle / 2);
    }
    return group;
}

TEST(PoseGroup, JoinsTheFirstThatIsNear) {
    const auto place = grouped({at(0), at(0.08), at(0.04), at(0.01), at(0.2), at(0.11)}, 0.05);
    std::vector<std::int64_t> group;
    for (const auto& one : place) group.push_back(one.group);
    EXPECT_EQ(group, (std::vector<std::int64_t>{0, 1, 0, 0, 2, 1}));
    EXPECT_TRUE(place[1].founds);
    EXPECT_FALSE(place[2].founds);
    EXPECT_EQ(place[2].near, (std::vector<std::int64_t>{0, 1}));
}

TEST(PoseGroup, AgreesWithComparingAllWithAll) {
    std::mt19937_64 random(1);
    for (const double range : {0.2, 0.6, 3.0}) {
        std::uniform_real_distribution<double> angle(-range, range);
        std::vector<Pose> pose;
        for (int k = 0; k < 600; ++k) {
            Pose one = Pose::Zero(4, 3);
            for (int joint = 1; joint < 3; ++joint) one.row(joint) << angle(random), angle(random), 0.3 * angle(random);
            pose.push_back(one);
        }
        const auto place = grouped(pose, 0.15);
        const std::vector<std::int64_t> group = expected(pose, 0.15);
        for (std::size_t k = 0; k < pose.size(); ++k) EXPECT_EQ(place[k].group, group[k]) << range << " " << k;
        // What comes later changes nothing, nor does how much is to come.
        const auto fewer = grouped(std::vector<Pose>(pose.begin(), pose.begin() + 100), 0.15);
        for (std::size_t k = 0; k < fewer.size(); ++k) EXPECT_EQ(fewer[k].group, group[k]);
    }
}

TEST(PoseGroup, WithoutAnAngleEachIsAlone) {
    const auto place = grouped({at(0), at(0), at(1)}, 0);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(place[k].group, static_cast<std::int64_t>(k));
    EXPECT_TRUE(grouped({}, 0.05).empty());
}

TEST(PoseGroup, StandstillsCostNothing) {
    const auto place = grouped(std::vector<Pose>(20000, at(0.3)), 0.05);
    EXPECT_EQ(place.back().group, 0);
    EXPECT_EQ(place.back().near.size(), 1u);
}

}  // namespace
}  // namespace toile::skin
