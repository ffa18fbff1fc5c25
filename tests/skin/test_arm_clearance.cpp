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

/// How far the left wrist is from the middle plane of the body [m].
double wrist_off_middle(const Pose& pose) {
    return forward_kinematics(body(), pose)[body().role[Role::left_hand]](0, 3);
}

TEST(ArmClearance, LeavesArmsAloneThatAreClear) {
    const ArmClearance clearance(body(), SkinningMethod::linear, gap);
    for (const double raise : {0.0, -0.8, 1.2}) EXPECT_EQ(clearance.clear(arms_at(raise)), arms_at(raise)) << raise;
}

TEST(ArmClearance, TurnsArmsOutOfTheTrunkAndNothingElse) {
    const Pose before = arms_at(-1.65);
    const Pose after = ArmClearance(body(), SkinningMethod::linear, gap).clear(before);
    EXPECT_GT(wrist_off_middle(after), wrist_off_middle(before) + 0.01);
    EXPECT_EQ(ArmClearance(body(), SkinningMethod::linear, gap).clear(after), after);
    EXPECT_LE(largest_joint_rotation(before, after), ArmClearance::largest_turn);
    for (int j = 0; j < body().joint_count(); ++j) {
        if (j == body().role[Role::left_upper_arm] || j == body().role[Role::right_upper_arm]) continue;
        EXPECT_EQ(after.row(j), before.row(j)) << body().joint[j].name;
    }
}

TEST(ArmClearance, KeepsAPoseItWouldHaveToTurnTooFar) {
    RoleAngles angles;
    angles.angle[Role::left_upper_arm] = {-2.6, 0.6, 0.0};  // across the belly, deep inside
    const Pose before = pose_from_angles(body(), angles);
    EXPECT_EQ(ArmClearance(body(), SkinningMethod::linear, gap).clear(before), before);
}

TEST(ClearedPoses, AreThoseOfTheirSourceCleared) {
    const std::vector<Pose> list{arms_at(-1.65), arms_at(0.2)};
    const ClearedPoses cleared(std::make_unique<PoseList>(list), body(), SkinningMethod::linear, gap);
    ASSERT_EQ(cleared.count(), 2);
    EXPECT_EQ(cleared.pose(0), ArmClearance(body(), SkinningMethod::linear, gap).clear(list[0]));
    EXPECT_EQ(cleared.pose(1), list[1]);
}

}  // namespace
}  // namespace toile::skin
