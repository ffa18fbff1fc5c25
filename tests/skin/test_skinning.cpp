#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "skin/skinning.h"
#include "tests/skin/two_bones.h"

namespace toile::skin {
namespace {

using testing_support::two_bones;

Pose bent() {
    Pose pose(2, 3);
    pose << 0.3, -0.2, 0.9, -1.4, 0.5, 0.1;
    return pose;
}

/// A body turned and moved as a whole, root and all: what a rigid motion of the world would do.
Body moved(Body body, const Eigen::Affine3d& motion) {
    for (Joint& joint : body.joint) joint.bind = motion.matrix() * joint.bind;
    for (int v = 0; v < body.vertex_count(); ++v)
        body.rest_position.row(v) = (motion * body.rest_position.row(v).transpose()).transpose();
    return body;
}

TEST(SkinPositions, BindPoseIsTheRestSurface) {
    const Body body = two_bones();
    for (const SkinningMethod method : {SkinningMethod::linear, SkinningMethod::dual_quaternion})
        EXPECT_TRUE(skin_positions(body, Pose::Zero(2, 3), method).isApprox(body.rest_position, 1e-14));
}

TEST(SkinPositions, LinearIsTheWeightedSumOfRigidMotions) {
    const Body body = two_bones();
    const auto transform = skinning_transforms(body, bent());
    const Positions posed = skin_positions(body, bent(), SkinningMethod::linear);
    for (int v = 0; v < body.vertex_count(); ++v) {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int i = body.weight.offset[v]; i < body.weight.offset[v + 1]; ++i)
            sum += body.weight.value[i] * transform[body.weight.joint[i]] *
                   body.rest_position.row(v).transpose().homogeneous();
        EXPECT_LT((posed.row(v).transpose() - sum.head<3>()).norm(), 1e-14);
    }
}

TEST(SkinPositions, OneJointMovesRigidlyInBothMethods) {
    const Body body = two_bones();
    const auto transform = skinning_transforms(body, bent());
    for (const SkinningMethod method : {SkinningMethod::linear, SkinningMethod::dual_quaternion}) {
        const Positions posed = skin_positions(body, bent(), method);
        for (const auto& [v, joint] : {std::pair{0, 0}, {4, 1}}) {
            const Eigen::Vector4d rigid = transform[joint] * body.rest_position.row(v).transpose().homogeneous();
            EXPECT_LT((posed.row(v).transpose() - rigid.head<3>()).norm(), 1e-14);
        }
    }
}

TEST(SkinPositions, DualQuaternionsKeepDistanceToTheAxisOfATwist) {
    Body body = two_bones();
    for (Joint& joint : body.joint) joint.bind.topLeftCorner<3, 3>().setIdentity();
    Pose twist = Pose::Zero(2, 3);
    twist(1, 1) = 2.5;  // about the line through both joints, where linear skinning collapses
    const auto distance = [](const Positions& p, int v) { return std::hypot(p(v, 0) - 0.1, p(v, 2) - 0.3); };
    const Positions dual = skin_positions(body, twist, SkinningMethod::dual_quaternion);
    const Positions linear = skin_positions(body, twist, SkinningMethod::linear);
    for (int v = 0; v < body.vertex_count(); ++v)
        EXPECT_NEAR(distance(dual, v), distance(body.rest_position, v), 1e-14);
    EXPECT_LT(distance(linear, 2), 0.6 * distance(body.rest_position, 2));
}

TEST(BlendedRotations, SingleJointsGiveTheirRotation) {
    const Body body = two_bones();
    const auto transform = skinning_transforms(body, bent());
    const auto blended = blended_rotations(body, bent());
    ASSERT_EQ(blended.size(), 5u);
    for (const auto& [v, joint] : {std::pair{0, 0}, {4, 1}})
        EXPECT_TRUE(blended[v].toRotationMatrix().isApprox(transform[joint].topLeftCorner<3, 3>(), 1e-14));
    // Half of each: half the angle between them, from either.
    const Eigen::Quaterniond middle = blended[2];
    EXPECT_NEAR(middle.angularDistance(blended[0]), middle.angularDistance(blended[4]), 1e-12);
    EXPECT_NEAR(2 * middle.angularDistance(blended[0]), blended[0].angularDistance(blended[4]), 1e-12);
}

TEST(BlendedRotations, RigidMotionOfTheBodyMultipliesFromTheLeft) {
    const Body body = two_bones();
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.linear() = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();
    motion.translation() << 3, 4, 5;
    // The same motion by the root's own rotation: R θ = B^-1 Q B θ for the rotation part.
    Pose pose = bent();
    const Eigen::Matrix3d bind = body.joint[0].bind.topLeftCorner<3, 3>();
    const Eigen::Matrix3d root =
        bind.transpose() * motion.linear() * bind *
        Eigen::AngleAxisd(pose.row(0).norm(), pose.row(0).normalized().transpose()).toRotationMatrix();
    const Eigen::AngleAxisd turned(root);
    pose.row(0) = (turned.angle() * turned.axis()).transpose();
    const auto before = blended_rotations(body, bent()), after = blended_rotations(body, pose);
    for (size_t v = 0; v < before.size(); ++v)
        EXPECT_NEAR((Eigen::Quaterniond(motion.linear()) * before[v]).angularDistance(after[v]), 0, 1e-7);
    // And positions follow a body that was moved with all its bind transforms.
    for (const SkinningMethod method : {SkinningMethod::linear, SkinningMethod::dual_quaternion}) {
        const Positions here = skin_positions(body, bent(), method);
        const Positions there = skin_positions(moved(body, motion), bent(), method);
        for (int v = 0; v < body.vertex_count(); ++v)
            EXPECT_LT((motion * here.row(v).transpose() - there.row(v).transpose()).norm(), 1e-13);
    }
}

}  // namespace
}  // namespace toile::skin
