#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth/error.h"
#include "skin/motion_fit.h"
#include "tests/skin/stick_body.h"
#include "tests/skin/t_pose_motion.h"

namespace toile::skin {
namespace {

using testing_support::joint_named;
using testing_support::stick_body;
using testing_support::t_pose_motion;

Eigen::Matrix3d z_up() {
    return Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
}

const MotionFit::Link& link(const MotionFit& fit, const Body& body, Role role) {
    for (const MotionFit::Link& l : fit.link)
        if (l.body_joint == body.role[role]) return l;
    throw Error("no link for " + std::string(role_name(role)));
}

TEST(MotionFit, FindsAxesUnitAndRoles) {
    const Body body = stick_body();
    const Eigen::Matrix3d aslant =
        Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).toRotationMatrix();  // faces no axis
    for (const Eigen::Matrix3d& axes : {Eigen::Matrix3d::Identity().eval(), z_up(), aslant}) {
        const files::Motion motion = t_pose_motion(1, axes);
        const MotionFit fit = fit_motion(body, motion, {}, "a.bvh");
        EXPECT_TRUE(fit.axes.isApprox(axes.transpose(), 1e-9)) << fit.axes;
        EXPECT_NEAR(fit.metres_per_unit, 0.1, 0.02);
        EXPECT_EQ(fit.pelvis, 0);
        EXPECT_EQ(fit.link.size(), 18u);
        EXPECT_FALSE(fit.remarks.empty());
    }
}

TEST(MotionFit, AccumulatesRotationsBetweenRoles) {
    const Body body = stick_body();
    const files::Motion motion = t_pose_motion(1);
    const MotionFit fit = fit_motion(body, motion, {}, "a.bvh");
    EXPECT_EQ(link(fit, body, Role::spine).source, joint_named(motion, "Spine"));
    EXPECT_EQ(link(fit, body, Role::chest).source, joint_named(motion, "Spine1"));
    EXPECT_EQ(link(fit, body, Role::left_lower_arm).source, joint_named(motion, "LeftForeArmTwist"));
    EXPECT_EQ(link(fit, body, Role::left_upper_arm).source, joint_named(motion, "LeftArm"));
}

TEST(MotionFit, AlignsLimbsAndNothingElse) {
    const Body body = stick_body();
    const MotionFit fit = fit_motion(body, t_pose_motion(1), {}, "a.bvh");
    EXPECT_TRUE(link(fit, body, Role::chest).align.isIdentity());
    EXPECT_TRUE(link(fit, body, Role::left_clavicle).align.isIdentity());
    const Eigen::Vector3d bone = Eigen::Vector3d(0.2, -0.2, 0).normalized();
    const MotionFit::Link& arm = link(fit, body, Role::left_upper_arm);
    EXPECT_TRUE((arm.align * bone).isApprox(Eigen::Vector3d::UnitX()));
    EXPECT_NEAR(Eigen::AngleAxisd(arm.align).angle(), M_PI / 4, 1e-9);  // the smallest there is
    EXPECT_TRUE(link(fit, body, Role::left_hand).align.isApprox(link(fit, body, Role::left_lower_arm).align));
}

TEST(MotionFit, TakesGivenJointsAxisAndUnit) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(1, z_up());
    for (std::size_t j = 1; j < motion.joint_name.size(); ++j) motion.joint_name[j] = "b" + std::to_string(j);
    motion.joint_name[7] = "b_7";
    MotionFitOptions options;
    options.up = "z";
    options.metres_per_unit = 0.11;
    options.joint = {{Role::left_upper_arm, "b 7"},
                     {Role::left_lower_arm, "b8"},
                     {Role::left_hand, "b10"},
                     {Role::right_upper_arm, "b12"},
                     {Role::pelvis, "Hips"}};
    const MotionFit fit = fit_motion(body, motion, options, "a.bvh");
    EXPECT_EQ(fit.role[Role::left_upper_arm], 7);
    EXPECT_EQ(fit.metres_per_unit, 0.11);
    EXPECT_TRUE(fit.axes.isApprox(z_up().transpose(), 1e-9));
}

std::string error(const Body& body, const files::Motion& motion, const MotionFitOptions& options) {
    try {
        fit_motion(body, motion, options, "a.bvh");
    } catch (const Error& e) {
        EXPECT_EQ(e.where(), "a.bvh");
        return e.what();
    }
    return {};
}

TEST(MotionFit, RefusesOneDefectAtATime) {
    const Body body = stick_body();
    const files::Motion valid = t_pose_motion(1);
    ASSERT_EQ(error(body, valid, {}), "");

    MotionFitOptions options;
    options.joint[Role::left_hand] = "LeftPaw";
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("no joint 'LeftPaw' for the role left_hand"));
    files::Motion motion = valid;
    motion.joint_name[10] = motion.joint_name[15] = "LeftPaw";
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("several joints 'LeftPaw'"));
    options = {};
    options.up = "north";
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("up is 'north'"));
    options.up = "z";
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("does not stand along up = z"));
    options.up = "-y";
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("does not stand along up = -y"));
    options = {};
    options.metres_per_unit = -1;
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("metres_per_unit"));
    options.metres_per_unit = 0.001;
    EXPECT_THAT(error(body, valid, options), testing::HasSubstr("trunk and leg are"));

    motion = valid;
    motion.rest_offset.setZero();
    EXPECT_THAT(error(body, motion, {}), testing::HasSubstr("which way is up"));
    motion = valid;
    motion.rest_offset.col(0).setZero();
    EXPECT_THAT(error(body, motion, {}), testing::HasSubstr("left from right"));
    motion = valid;
    for (std::size_t j = 0; j < motion.joint_name.size(); ++j) motion.joint_name[j] = "b" + std::to_string(j);
    EXPECT_THAT(error(body, motion, {}), testing::HasSubstr("pelvis"));
    Body blank = body;
    blank.role = RoleMap();
    EXPECT_THAT(error(blank, valid, {}), testing::HasSubstr("matches"));
}

}  // namespace
}  // namespace toile::skin
