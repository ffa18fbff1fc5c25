#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "cloth/error.h"
#include "skin/pose_sampler.h"
#include "tests/skin/stick_body.h"

namespace toile::skin {
namespace {

using testing_support::stick_body;

TEST(PoseSampler, DependsOnSeedAndNumberAlone) {
    const Body body = stick_body();
    SamplerOptions options;
    options.seed = 5;
    const PoseSampler a(body, options), b(body, options);
    const Pose late = a.pose(1000003);
    EXPECT_EQ(a.pose(3), b.pose(3));
    EXPECT_EQ(late, b.pose(1000003));
    EXPECT_GT(largest_joint_rotation(a.pose(3), a.pose(4)), 0.01);
    options.seed = 6;
    EXPECT_GT(largest_joint_rotation(a.pose(3), PoseSampler(body, options).pose(3)), 0.01);
}

TEST(PoseSampler, StaysWithinLimitsAndFillsThem) {
    const Body body = stick_body();
    SamplerOptions options;
    options.limits[Role::left_upper_arm] = {{-1, 0.2, -0.3}, {1.5, 0.2, 0.4}};
    const PoseSampler sampler(body, options);
    // Of 64 points of a Sobol sequence, each of 64 equal parts of any axis holds exactly one.
    std::vector<double> raise;
    for (int k = 0; k < 64; ++k) {
        const RoleAngles angles = sampler.angles(k);
        for (const Role role : options.roles) {
            const JointLimit limit = role == Role::left_upper_arm ? options.limits.at(role) : default_limit(role);
            const Eigen::Vector3d angle = angles.angle.at(role);
            EXPECT_TRUE((angle.array() >= limit.lower.array()).all()) << role_name(role);
            EXPECT_TRUE((angle.array() <= limit.upper.array()).all()) << role_name(role);
        }
        EXPECT_EQ(angles.angle.at(Role::left_upper_arm)[1], 0.2);
        raise.push_back(angles.angle.at(Role::left_upper_arm)[0]);
    }
    std::sort(raise.begin(), raise.end());
    int evenly = 0;
    for (int i = 0; i < 64; ++i) evenly += std::floor((raise[i] + 1) / 2.5 * 64) == i;
    EXPECT_GE(evenly, 62);  // the points counted from 1 on, so one part may be empty
}

TEST(PoseSampler, MovesTheChosenJointsAlone) {
    const Body body = stick_body();
    SamplerOptions options;
    options.roles = {Role::left_lower_arm};
    const Pose pose = PoseSampler(body, options).pose(9);
    for (int j = 0; j < body.joint_count(); ++j)
        EXPECT_EQ(pose.row(j).norm() > 1e-9, j == body.role[Role::left_lower_arm]) << body.joint[j].name;
}

TEST(PoseSampler, SymmetricPosesMirrorThemselves) {
    const Body body = stick_body();
    SamplerOptions options;
    options.symmetric = true;
    const PoseSampler sampler(body, options);
    for (int k = 0; k < 5; ++k) {
        const RoleAngles angles = sampler.angles(k);
        EXPECT_EQ(angles.angle.at(Role::right_upper_arm), angles.angle.at(Role::left_upper_arm));
        const auto world = forward_kinematics(body, sampler.pose(k));
        const Eigen::Vector3d left = world[body.role[Role::left_hand]].topRightCorner<3, 1>();
        const Eigen::Vector3d right = world[body.role[Role::right_hand]].topRightCorner<3, 1>();
        EXPECT_LT((Eigen::Vector3d(-left.x(), left.y(), left.z()) - right).norm(), 1e-9);
    }
}

/// The error's message, or nothing.
std::string error(const Body& body, const SamplerOptions& options) {
    try {
        PoseSampler sampler(body, options, "scene.toml:poses");
    } catch (const Error& e) {
        EXPECT_EQ(e.where(), "scene.toml:poses");
        return e.what();
    }
    return {};
}

TEST(PoseSampler, RefusesOneDefectAtATime) {
    const Body body = stick_body();
    const SamplerOptions valid;
    ASSERT_EQ(error(body, valid), "");

    SamplerOptions options = valid;
    options.limits[Role::spine] = {{0, 0.3, 0}, {0, 0.2, 0}};
    EXPECT_THAT(error(body, options),
                testing::AllOf(testing::HasSubstr("swing of spine"), testing::HasSubstr("reversed")));
    options.limits[Role::spine] = {{0, 0, 0}, {0, 0, std::numeric_limits<double>::infinity()}};
    EXPECT_THAT(error(body, options),
                testing::AllOf(testing::HasSubstr("twist of spine"), testing::HasSubstr("not finite")));
    options.limits[Role::spine] = {{0, 0, 0}, {90, 0, 0}};
    EXPECT_THAT(error(body, options), testing::HasSubstr("beyond a whole turn"));
    options = valid;
    options.limits[Role::left_foot] = {{0, 0, 0}, {0, 0, 0}};
    EXPECT_THAT(error(body, options), testing::HasSubstr("left_foot, which does not move"));
    options = valid;
    options.roles.push_back(Role::spine);
    EXPECT_THAT(error(body, options), testing::HasSubstr("listed twice"));
    options.roles.clear();
    EXPECT_THAT(error(body, options), testing::HasSubstr("no joint is chosen"));
    Body armless = body;
    armless.role[Role::left_lower_arm] = -1;
    EXPECT_THAT(error(armless, valid), testing::HasSubstr("left_lower_arm"));
    EXPECT_THROW(PoseSampler(body, valid).pose(-1), Error);
}

}  // namespace
}  // namespace toile::skin
