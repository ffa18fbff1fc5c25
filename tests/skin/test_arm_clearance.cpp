#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "skin/anatomy.h"
#include "skin/arm_clearance.h"
#include "skin/builtin_body.h"
#include "skin/surface_query.h"

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

/// Vertices that one joint holds whole.
std::vector<int> held_by(Role role) {
    std::vector<int> held;
    for (int v = 0; v < body().vertex_count(); ++v)
        for (int k = body().weight.offset[v]; k < body().weight.offset[v + 1]; ++k)
            if (body().weight.joint[k] == body().role[role] && body().weight.value[k] > 0.999) held.push_back(v);
    return held;
}

/// How far the left lower arm is from the spine's surface, negative inside [m].
double arm_to_trunk(const Pose& pose) {
    const Positions x = skin_positions(body(), pose, SkinningMethod::linear);
    const SurfaceQuery all(body().triangle, x);
    std::vector<bool> of_arm(static_cast<size_t>(body().vertex_count()), false);
    const std::vector<int> arm = held_by(Role::left_lower_arm);
    for (const Role role : {Role::left_upper_arm, Role::left_lower_arm, Role::left_hand})
        for (const int v : held_by(role)) of_arm[v] = true;
    std::vector<int> kept;
    for (int f = 0; f < body().triangle.rows(); ++f)
        if (!of_arm[body().triangle(f, 0)] && !of_arm[body().triangle(f, 1)] && !of_arm[body().triangle(f, 2)])
            kept.push_back(f);
    const Triangles trunk = body().triangle(kept, Eigen::all);
    const SurfaceQuery query(trunk, x);
    double least = std::numeric_limits<double>::infinity();
    for (const int v : arm) least = std::min(least, query.nearest(x.row(v).transpose()).signed_distance);
    return least;
}

TEST(ArmClearance, LeavesArmsAloneThatAreClear) {
    const ArmClearance clearance(body(), SkinningMethod::linear, gap);
    for (const double raise : {0.0, -0.8, 1.2}) EXPECT_EQ(clearance.clear(arms_at(raise)), arms_at(raise)) << raise;
}

TEST(ArmClearance, TurnsArmsOutOfTheTrunkAndNothingElse) {
    const Pose before = arms_at(-1.65);
    ASSERT_LT(arm_to_trunk(before), 0.5 * gap);
    const Pose after = ArmClearance(body(), SkinningMethod::linear, gap).clear(before);
    EXPECT_GE(arm_to_trunk(after), gap);
    EXPECT_LE(largest_joint_rotation(before, after), ArmClearance::largest_turn);
    for (int j = 0; j < body().joint_count(); ++j)
        if (j != body().role[Role::left_upper_arm] && j != body().role[Role::right_upper_arm])
            EXPECT_EQ(after.row(j), before.row(j)) << body().joint[j].name;
}

TEST(ArmClearance, KeepsAPoseItWouldHaveToTurnTooFar) {
    RoleAngles angles;
    angles.angle[Role::left_upper_arm] = {-1.2, 0.6, 0.0};
    angles.angle[Role::left_lower_arm] = {0.0, 0.0, 0.0};
    angles.angle[Role::left_upper_arm][0] = -2.6;  // across the belly, deep inside
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
