#include <gtest/gtest.h>

#include "skin/anatomy.h"
#include "skin/arm_clearance.h"
#include "skin/builtin_body.h"

namespace toile::skin {
namespace {

constexpr double gap = 0.012;

const Body& body() {
    static const Body made = make_builtin_body({});
    return made;
}

Pose arms_at(double raise, double swing = 0.0) {
    RoleAngles angles;
    for (const Role role : {Role::left_upper_arm, Role::right_upper_arm}) angles.angle[role] = {raise, swing, 0.0};
    return pose_from_angles(body(), angles);
}

TEST(ArmClearance, LeavesArmsAloneThatAreClear) {
    const ArmClearance clearance(body(), SkinningMethod::linear, gap);
    for (const double raise : {0.0, -0.8, 1.2}) EXPECT_EQ(clearance.clear(arms_at(raise)), arms_at(raise)) << raise;
}

TEST(ArmClearance, TurnsArmsAwayUntilTheyAreClear) {
    const ArmClearance clearance(body(), SkinningMethod::linear, gap);
    int turned = 0;
    for (double raise = -1.4; raise > -1.95; raise -= 0.1) {
        const Pose before = arms_at(raise), after = clearance.clear(before);
        if (after == before) continue;
        ++turned;
        const double turn = largest_joint_rotation(before, after);
        EXPECT_GT(turn, 0.01) << raise;
        EXPECT_LE(turn, ArmClearance::largest_turn + 1e-9) << raise;
        EXPECT_EQ(clearance.clear(after), after) << "clear now, " << raise;
    }
    EXPECT_GT(turned, 0);
}

TEST(ArmClearance, KeepsAPoseItWouldHaveToTurnTooFar) {
    RoleAngles angles;
    angles.angle[Role::left_upper_arm] = {-2.6, 0.6, 0.0};  // across the belly, deep inside
    const Pose before = pose_from_angles(body(), angles);
    EXPECT_EQ(ArmClearance(body(), SkinningMethod::linear, gap).clear(before), before);
}

TEST(ClearedPoses, AreThoseOfTheirSourceCleared) {
    const std::vector<Pose> list{arms_at(-1.8), arms_at(0.2)};
    const ClearedPoses cleared(std::make_unique<PoseList>(list), body(), SkinningMethod::linear, gap);
    ASSERT_EQ(cleared.count(), 2);
    EXPECT_EQ(cleared.pose(0), ArmClearance(body(), SkinningMethod::linear, gap).clear(list[0]));
    EXPECT_EQ(cleared.pose(1), list[1]);
}

}  // namespace
}  // namespace toile::skin
