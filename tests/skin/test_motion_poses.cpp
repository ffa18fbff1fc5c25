#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "cloth/error.h"
#include "skin/motion_poses.h"
#include "tests/skin/stick_body.h"
#include "tests/skin/t_pose_motion.h"

namespace toile::skin {
namespace {

using testing_support::joint_named;
using testing_support::stick_body;
using testing_support::t_pose_motion;
using testing_support::turn;

std::vector<Pose> follow(const Body& body, const files::Motion& motion, const MotionOptions& options = {}) {
    return motion_poses(body, motion, fit_motion(body, motion, options, "a.bvh"), options, "a.bvh");
}

Eigen::Vector3d bone(const Body& body, const Pose& pose, Role from, Role to) {
    const auto world = forward_kinematics(body, pose);
    return (world[body.role[to]].topRightCorner<3, 1>() - world[body.role[from]].topRightCorner<3, 1>()).normalized();
}

/// Turns every joint of every frame at random, by up to `most` rad about each axis.
void shake(files::Motion& motion, double most, const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity()) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> angle(-most, most);
    for (int frame = 0; frame < motion.frame_count; ++frame)
        for (const std::string& name : motion.joint_name) {
            const double x = angle(random), y = angle(random), z = angle(random);
            turn(motion, frame, name, {x, y, z}, axes);
        }
}

/// Positions of the motion's joints, evaluated here by themselves.
std::vector<Eigen::Vector3d> joint_positions(const files::Motion& motion, int frame) {
    std::vector<Eigen::Vector3d> position;
    std::vector<Eigen::Matrix3d> rotation;
    for (int j = 0; j < motion.joint_count(); ++j) {
        const int parent = motion.joint_parent[j];
        const Eigen::Vector3d offset = motion.rest_offset.row(j).transpose();
        const Eigen::Matrix3d local = motion.local_rotation(frame, j).toRotationMatrix();
        position.push_back(parent < 0 ? offset : Eigen::Vector3d(position[parent] + rotation[parent] * offset));
        rotation.push_back(parent < 0 ? local : Eigen::Matrix3d(rotation[parent] * local));
    }
    return position;
}

TEST(MotionPoses, RestPoseOfTheMotionMakesATPose) {
    const Body body = stick_body();
    const std::vector<Pose> pose = follow(body, t_pose_motion(3));
    ASSERT_EQ(pose.size(), 3u);
    for (const auto& [from, to, x] : {std::tuple{Role::left_upper_arm, Role::left_lower_arm, 1.0},
                                      std::tuple{Role::left_lower_arm, Role::left_hand, 1.0},
                                      std::tuple{Role::right_upper_arm, Role::right_lower_arm, -1.0},
                                      std::tuple{Role::right_lower_arm, Role::right_hand, -1.0}})
        EXPECT_TRUE(bone(body, pose[1], from, to).isApprox(Eigen::Vector3d(x, 0, 0), 1e-9));
    for (const Role role : {Role::pelvis, Role::spine, Role::chest, Role::neck, Role::head, Role::left_clavicle})
        EXPECT_LT(pose[1].row(body.role[role]).norm(), 1e-9) << role_name(role);
}

TEST(MotionPoses, LimbsPointWhereTheMotionsDo) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(10);
    shake(motion, 0.7);
    for (int frame = 0; frame < motion.frame_count; ++frame)  // one bone in the motion, as in the body
        for (const char* name : {"LeftForeArmTwist", "RightForeArmTwist"}) turn(motion, frame, name, {0, 0, 0});
    const std::vector<Pose> pose = follow(body, motion);
    for (int frame = 0; frame < motion.frame_count; ++frame) {
        const auto at = joint_positions(motion, frame);
        const Eigen::Quaterniond pelvis = motion.local_rotation(frame, 0);
        const auto expect = [&](Role from, Role to, const std::string& first, const std::string& next) {
            const Eigen::Vector3d expected =
                pelvis.conjugate() * (at[joint_named(motion, next)] - at[joint_named(motion, first)]).normalized();
            EXPECT_TRUE(bone(body, pose[frame], from, to).isApprox(expected, 1e-9)) << first << " of frame " << frame;
        };
        expect(Role::left_upper_arm, Role::left_lower_arm, "LeftArm", "LeftForeArm");
        expect(Role::left_lower_arm, Role::left_hand, "LeftForeArm", "LeftHand");
        expect(Role::right_upper_arm, Role::right_lower_arm, "RightArm", "RightForeArm");
        expect(Role::right_lower_arm, Role::right_hand, "RightForeArm", "RightHand");
        expect(Role::left_upper_leg, Role::left_lower_leg, "LeftUpLeg", "LeftLeg");
        expect(Role::left_lower_leg, Role::left_foot, "LeftLeg", "LeftFoot");
        expect(Role::right_upper_leg, Role::right_lower_leg, "RightUpLeg", "RightLeg");
        expect(Role::right_lower_leg, Role::right_foot, "RightLeg", "RightFoot");
    }
}

TEST(MotionPoses, LeftStaysLeft) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(1);
    turn(motion, 0, "LeftArm", {0, 0, 1.2});  // raises the left arm
    turn(motion, 0, "Spine", {0.3, 0, 0});    // bows
    const Pose pose = follow(body, motion).front();
    EXPECT_GT(bone(body, pose, Role::left_upper_arm, Role::left_hand).y(), 0.8);
    EXPECT_LT(std::abs(bone(body, pose, Role::right_upper_arm, Role::right_hand).y()), 1e-9);
    EXPECT_GT(bone(body, pose, Role::chest, Role::neck).z(), 0.2);
}

TEST(MotionPoses, DoesNotDependOnTheFilesAxes) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(4);
    shake(motion, 1);
    const std::vector<Pose> expected = follow(body, motion);
    for (const Eigen::Vector3d& turn_by : {Eigen::Vector3d(M_PI / 2, 0, 0), Eigen::Vector3d(0, 0, -M_PI / 2),
                                           Eigen::Vector3d(0, 0.7, 0), Eigen::Vector3d(M_PI, 0, 0)}) {
        const Eigen::Matrix3d axes = Eigen::AngleAxisd(turn_by.norm(), turn_by.normalized()).toRotationMatrix();
        files::Motion turned = t_pose_motion(4, axes);
        shake(turned, 1, axes);
        const std::vector<Pose> pose = follow(body, turned);
        for (std::size_t k = 0; k < pose.size(); ++k) EXPECT_LT(largest_joint_rotation(pose[k], expected[k]), 1e-7);
    }
}

TEST(MotionPoses, DoesNotDependOnWherePeopleGo) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(2);
    shake(motion, 0.5);
    const Pose expected = follow(body, motion).front();
    turn(motion, 0, "Hips", {2, -1, 3});
    motion.root_translation.setConstant(40);
    EXPECT_LT(largest_joint_rotation(follow(body, motion).front(), expected), 1e-7);
}

TEST(MotionPoses, MeansTheSameWhateverTheRigsAxes) {
    files::Motion motion = t_pose_motion(1);
    shake(motion, 0.8);
    const Body odd = stick_body(), plain = stick_body(true);
    const auto a = forward_kinematics(odd, follow(odd, motion).front());
    const auto b = forward_kinematics(plain, follow(plain, motion).front());
    for (std::size_t j = 0; j < a.size(); ++j)
        EXPECT_LT((a[j].topRightCorner<3, 1>() - b[j].topRightCorner<3, 1>()).norm(), 1e-9);
}

TEST(MotionPoses, JointsWithoutACounterpartKeepTheirBindPose) {
    Body body = stick_body();
    const int clavicle = body.role[Role::left_clavicle];
    body.role[Role::left_clavicle] = -1;
    files::Motion motion = t_pose_motion(1);
    shake(motion, 0.8);
    const Pose pose = follow(body, motion).front();
    EXPECT_TRUE(pose.row(clavicle).isZero());
    EXPECT_TRUE(pose.row(0).isZero());
    for (int j = 0; j < body.joint_count(); ++j) {
        if (!body.joint[j].name.starts_with("finger")) continue;
        EXPECT_TRUE(pose.row(j).isZero());
    }
}

TEST(MotionPoses, TakesFramesByRangeAndStride) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(11);
    for (int frame = 0; frame < 11; ++frame) turn(motion, frame, "Head", {0.1 * frame, 0, 0});
    MotionOptions options;
    options.first_frame = 2;
    options.last_frame = 9;
    options.stride = 3;
    const std::vector<Pose> pose = follow(body, motion, options);
    ASSERT_EQ(pose.size(), 3u);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(pose[k].row(body.role[Role::head]).norm(), 0.1 * (2 + 3 * k), 1e-9);
}

TEST(MotionPoses, InterpolatesOnTheSphereAcrossEulerWraps) {
    const Body body = stick_body();
    files::Motion motion = t_pose_motion(3);
    // About one axis, 170, 190 and 210 degrees; written as Euler angles these would jump from 170 to -170. The signs
    // of the quaternions jump as well.
    for (int frame = 0; frame < 3; ++frame) turn(motion, frame, "Head", {0, (170 + 20 * frame) * M_PI / 180, 0});
    motion.rotation[static_cast<std::size_t>(motion.joint_count() + joint_named(motion, "Head"))].coeffs() *= -1;
    MotionOptions options;
    options.rate = 40;  // frames are 0.1 s apart
    const std::vector<Pose> pose = follow(body, motion, options);
    ASSERT_EQ(pose.size(), 9u);
    for (std::size_t k = 1; k < pose.size(); ++k)
        EXPECT_NEAR(largest_joint_rotation(pose[k - 1], pose[k]), 5 * M_PI / 180, 1e-9);
    options.rate = 20.0 / 3;  // 0.15 s: the last frame is not met
    EXPECT_EQ(follow(body, motion, options).size(), 2u);
}

std::string error(const Body& body, const files::Motion& motion, const MotionOptions& options) {
    try {
        follow(body, motion, options);
    } catch (const Error& e) {
        EXPECT_EQ(e.where(), "a.bvh");
        return e.what();
    }
    return {};
}

TEST(MotionPoses, RefusesOneDefectAtATime) {
    const Body body = stick_body();
    const files::Motion motion = t_pose_motion(10);
    const MotionOptions valid;
    ASSERT_EQ(error(body, motion, valid), "");
    MotionOptions options = valid;
    options.first_frame = -1;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("-1 to 9 are not a range of the motion's 10 frames"));
    options.first_frame = 10;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("range"));
    options = valid;
    options.last_frame = 10;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("range"));
    options.first_frame = 5;
    options.last_frame = 4;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("range"));
    options = valid;
    options.stride = 0;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("stride is 0"));
    options = valid;
    options.rate = -1;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("rate"));
    options.rate = 1e12;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("too many poses"));
    options.rate = 30;
    options.stride = 2;
    EXPECT_THAT(error(body, motion, options), testing::HasSubstr("both"));
    options.stride = 1;
    files::Motion still = motion;
    still.frame_time = 0;
    EXPECT_THAT(error(body, still, options), testing::HasSubstr("no frame time"));
}

TEST(MotionPoses, ReadsABvhFile) {
    const std::string path = testing::TempDir() + "toile_motion_poses.bvh";
    std::ofstream(path) << R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation
  JOINT Spine
  {
    OFFSET 0 0 10
    CHANNELS 3 Yrotation Xrotation Zrotation
    JOINT LeftArm
    {
      OFFSET -15 0 40
      CHANNELS 3 Yrotation Xrotation Zrotation
      JOINT LeftForeArm
      {
        OFFSET -28 0 0
        CHANNELS 3 Yrotation Xrotation Zrotation
        End Site
        {
          OFFSET -25 0 0
        }
      }
    }
    JOINT RightArm
    {
      OFFSET 15 0 40
      CHANNELS 3 Yrotation Xrotation Zrotation
      End Site
      {
        OFFSET 28 0 0
      }
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.04
0 0 90  0 0 77  0 0 0  90 0 0  0 0 0  0 0 0
)";
    const Body body = stick_body();
    const MotionPoses motion = read_motion_poses(body, path);
    std::filesystem::remove(path);
    EXPECT_TRUE(motion.fit.axes.row(1).isApprox(Eigen::RowVector3d::UnitZ()));
    EXPECT_TRUE(motion.fit.axes.row(0).isApprox(-Eigen::RowVector3d::UnitX()));
    // 90 degrees about y takes the left arm from -x to +z, which is up there.
    EXPECT_TRUE(bone(body, motion.poses.pose(0), Role::left_upper_arm, Role::left_lower_arm)
                    .isApprox(Eigen::Vector3d::UnitY(), 1e-5));
    EXPECT_TRUE(bone(body, motion.poses.pose(0), Role::left_lower_arm, Role::left_hand)
                    .isApprox(Eigen::Vector3d::UnitY(), 1e-5));
}

}  // namespace
}  // namespace toile::skin
