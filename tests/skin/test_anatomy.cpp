#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "cloth/error.h"
#include "skin/anatomy.h"
#include "skin/rigged_body.h"
#include "tests/skin/stick_body.h"

namespace toile::skin {
namespace {

using Eigen::Vector3d;
using testing_support::stick_body;

Vector3d place(const std::vector<Eigen::Matrix4d>& world, const Body& body, Role role) {
    return world[body.role[role]].topRightCorner<3, 1>();
}

Vector3d bone(const Body& body, const Pose& pose, Role from, Role to) {
    const auto world = forward_kinematics(body, pose);
    return (place(world, body, to) - place(world, body, from)).normalized();
}

Vector3d left_arm(const Body& body, const RoleAngles& angles) {
    return bone(body, pose_from_angles(body, angles), Role::left_upper_arm, Role::left_lower_arm);
}

Vector3d right_arm(const Body& body, const RoleAngles& angles) {
    return bone(body, pose_from_angles(body, angles), Role::right_upper_arm, Role::right_lower_arm);
}

/// Every body at hand: the stick figure with odd and with plain bind frames, and the real ones where they are.
std::vector<Body> bodies() {
    std::vector<Body> all = {stick_body(), stick_body(true)};
    for (const char* name : {"/bodies/mh_female_cmu.glb", "/bodies/mh_male_default.glb"})
        if (std::filesystem::exists(TOILE_SHARED_DATA + std::string(name)))
            all.push_back(read_rigged_body(TOILE_SHARED_DATA + std::string(name)).body);
    return all;
}

TEST(PoseFromAngles, ArmDirectionIsTheSameOnEveryBody) {
    for (const Body& body : bodies()) {
        for (const double raise : {-1.5, -0.7, 0.0, 0.3, 1.0, 1.5}) {
            for (const double swing : {-0.4, 0.0, 0.8, 1.3}) {
                RoleAngles angles;
                angles.angle[Role::left_upper_arm] = angles.angle[Role::right_upper_arm] = {raise, swing, 0.4};
                const Vector3d expected(std::cos(raise) * std::cos(swing), std::sin(raise) * std::cos(swing),
                                        std::sin(swing));
                EXPECT_LT((left_arm(body, angles) - expected).norm(), 1e-6);
                EXPECT_LT((right_arm(body, angles) - Vector3d(-expected.x(), expected.y(), expected.z())).norm(), 1e-6);
            }
        }
    }
}

TEST(PoseFromAngles, ArmsFollowTheChestWhateverTheClavicleDoes) {
    for (const Body& body : bodies()) {
        RoleAngles angles;
        angles.angle[Role::left_upper_arm] = {1.2, 0.2, 0};
        angles.angle[Role::left_clavicle] = {0.3, -0.2, 0.1};
        const Vector3d before = left_arm(body, {{{Role::left_upper_arm, Vector3d(1.2, 0.2, 0)}}});
        EXPECT_LT((left_arm(body, angles) - before).norm(), 1e-6);
        angles.angle[Role::chest] = {0, 0, M_PI / 2};  // the chest turns to its left: what was ahead is at +x
        const Vector3d turned = left_arm(body, angles);
        EXPECT_LT((turned - Vector3d(before.z(), before.y(), -before.x())).norm(), 1e-6);
    }
}

TEST(PoseFromAngles, OverheadIsAboveTheHead) {
    for (const Body& body : bodies()) {
        RoleAngles angles;
        angles.angle[Role::left_upper_arm] = angles.angle[Role::right_upper_arm] = {M_PI / 2, 0, 0};
        const auto world = forward_kinematics(body, pose_from_angles(body, angles));
        EXPECT_GT(place(world, body, Role::left_hand).y(), place(world, body, Role::head).y() + 0.05);
        EXPECT_GT(place(world, body, Role::right_hand).y(), place(world, body, Role::head).y() + 0.05);
    }
}

TEST(PoseFromAngles, BindAnglesAreTheBindPose) {
    for (const Body& body : bodies()) {
        RoleAngles angles;
        for (int i = 0; i < role_count; ++i)
            angles.angle[static_cast<Role>(i)] = bind_angles(body, static_cast<Role>(i));
        EXPECT_LT(pose_from_angles(body, angles).cwiseAbs().maxCoeff(), 1e-7);
        angles.angle.clear();
        angles.angle[Role::left_upper_arm] = bind_angles(body, Role::left_upper_arm);
        EXPECT_LT(pose_from_angles(body, angles).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST(BindAngles, MeasureTheStickFigure) {
    const Vector3d upper = bind_angles(stick_body(), Role::left_upper_arm);
    EXPECT_NEAR(upper[0], -M_PI / 4, 1e-12);
    EXPECT_NEAR(upper[1], 0, 1e-12);
    EXPECT_NEAR((bind_angles(stick_body(), Role::right_upper_arm) - upper).norm(), 0, 1e-12);
    EXPECT_TRUE(bind_angles(stick_body(), Role::left_upper_leg).isZero());
    // The forearm leaves the upper arm's line by a little, upwards and ahead.
    const Vector3d lower = bind_angles(stick_body(), Role::left_lower_arm);
    EXPECT_LT(lower[0], 0);
    EXPECT_GT(lower[1], 0.05);
}

TEST(PoseFromAngles, ClavicleTakesAThirdAboveTheHorizontal) {
    const Body body = stick_body();
    const auto clavicle_turn = [&](double raise, double swing) {
        const Pose pose = pose_from_angles(body, {{{Role::left_upper_arm, Vector3d(raise, swing, 0)}}});
        return pose.row(body.role[Role::left_clavicle]).norm();
    };
    EXPECT_NEAR(clavicle_turn(-1.2, 0), 0, 1e-9);
    EXPECT_NEAR(clavicle_turn(0, 0), 0, 1e-9);
    EXPECT_NEAR(clavicle_turn(1.5, 0) - clavicle_turn(0.9, 0), 0.2, 1e-9);
    EXPECT_GT(clavicle_turn(1.5, 0), 0.35);
    EXPECT_LT(clavicle_turn(1.5, 1.4), 0.1);
    // It sets in smoothly.
    EXPECT_LT(clavicle_turn(0.01, 0), 1e-4);
}

TEST(PoseFromAngles, ElbowsBendAheadRelativeToTheUpperArm) {
    for (const Body& body : bodies()) {
        RoleAngles angles;
        angles.angle[Role::left_upper_arm] = angles.angle[Role::right_upper_arm] = {0, 0, 0};
        angles.angle[Role::left_lower_arm] = angles.angle[Role::right_lower_arm] = {0, 0, 0};
        Pose pose = pose_from_angles(body, angles);
        EXPECT_LT((bone(body, pose, Role::left_lower_arm, Role::left_hand) - Vector3d(1, 0, 0)).norm(), 1e-6);
        angles.angle[Role::left_lower_arm] = angles.angle[Role::right_lower_arm] = {0, M_PI / 2, 0};
        pose = pose_from_angles(body, angles);
        EXPECT_LT((bone(body, pose, Role::left_lower_arm, Role::left_hand) - Vector3d(0, 0, 1)).norm(), 1e-6);
        EXPECT_LT((bone(body, pose, Role::right_lower_arm, Role::right_hand) - Vector3d(0, 0, 1)).norm(), 1e-6);
        // A hanging arm keeps its forearm ahead: the bend goes with the upper arm.
        angles.angle[Role::left_upper_arm] = {-M_PI / 2, 0, 0};
        pose = pose_from_angles(body, angles);
        EXPECT_LT((bone(body, pose, Role::left_lower_arm, Role::left_hand) - Vector3d(0, 0, 1)).norm(), 1e-6);
    }
}

TEST(PoseFromAngles, TrunkAndLegsTurnAboutTheBodysAxes) {
    for (const Body& body : bodies()) {
        const auto moved = [&](Role role, const Vector3d& angle, Role end) {
            const auto rest = forward_kinematics(body, Pose::Zero(body.joint_count(), 3));
            const auto world = forward_kinematics(body, pose_from_angles(body, {{{role, angle}}}));
            return Vector3d(place(world, body, end) - place(rest, body, end));
        };
        EXPECT_GT(moved(Role::spine, {0.3, 0, 0}, Role::head).x(), 0.05);        // to the body's left
        EXPECT_GT(moved(Role::spine, {0, 0.3, 0}, Role::head).z(), 0.05);        // forward
        EXPECT_LT(moved(Role::spine, {0, 0, 0.3}, Role::left_hand).z(), -0.03);  // to the left
        EXPECT_GT(moved(Role::left_upper_leg, {0.4, 0, 0}, Role::left_foot).x(), 0.1);
        EXPECT_LT(moved(Role::right_upper_leg, {0.4, 0, 0}, Role::right_foot).x(), -0.1);
        EXPECT_GT(moved(Role::right_upper_leg, {0, 0.4, 0}, Role::right_foot).z(), 0.1);
        EXPECT_LT(moved(Role::right_lower_leg, {0, -0.8, 0}, Role::right_foot).z(), -0.1);
    }
}

TEST(PoseFromAngles, NamesARoleTheBodyLacks) {
    Body body = stick_body();
    body.role[Role::neck] = -1;
    try {
        pose_from_angles(body, {{{Role::neck, Vector3d(0.1, 0, 0)}}});
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("neck"));
    }
    EXPECT_THROW(bind_angles(body, Role::neck), Error);
    EXPECT_THROW(pose_from_angles(body, {{{Role::head, Vector3d(0, NAN, 0)}}}), Error);
    body.role[Role::spine] = body.role[Role::chest];
    EXPECT_THROW(pose_from_angles(body, {{{Role::spine, Vector3d::Zero()}, {Role::chest, Vector3d::Zero()}}}), Error);
}

TEST(PoseFromAngles, WorksWithoutClaviclesOrHands) {
    Body body = stick_body();
    for (const Role role : {Role::left_clavicle, Role::right_clavicle, Role::left_hand, Role::chest})
        body.role[role] = -1;
    const Vector3d arm = left_arm(body, {{{Role::left_upper_arm, Vector3d(0.5, 0.2, 0)}}});
    EXPECT_NEAR(arm.z(), std::sin(0.2), 1e-9);
    EXPECT_NO_THROW(pose_from_angles(body, {{{Role::left_lower_arm, Vector3d(0, 1, 0)}}}));
}

TEST(DefaultLimit, IsInOrderForEveryRole) {
    for (int i = 0; i < role_count; ++i) {
        const Role role = static_cast<Role>(i);
        EXPECT_NO_THROW(check_limit(role, default_limit(role), "x.toml"));
    }
    EXPECT_GT(default_limit(Role::left_upper_arm).upper[0], 1.4);
    EXPECT_LT(default_limit(Role::left_upper_arm).lower[0], -1.3);
}

TEST(CheckLimit, NamesRoleAndAxis) {
    const auto expect_refused = [](double lower, double upper, const char* word) {
        JointLimit limit = default_limit(Role::right_lower_arm);
        limit.lower[1] = lower;
        limit.upper[1] = upper;
        try {
            check_limit(Role::right_lower_arm, limit, "a.toml:poses.limits");
            ADD_FAILURE() << word;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("swing of right_lower_arm"));
            EXPECT_THAT(error.what(), testing::HasSubstr(word));
            EXPECT_EQ(error.where(), "a.toml:poses.limits");
        }
    };
    expect_refused(1.0, 0.5, "reversed");
    expect_refused(-90, 90, "whole turn");
    expect_refused(0, std::numeric_limits<double>::quiet_NaN(), "not finite");
}

}  // namespace
}  // namespace toile::skin
