#include "skin/pose.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "cloth/error.h"

namespace toile::skin {
namespace {

Eigen::Quaterniond from_axis_angle(const Eigen::Vector3d& rotation) {
    const double angle = rotation.norm();
    if (angle < 1e-300) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

Eigen::Vector3d to_axis_angle(const Eigen::Quaterniond& q) {
    const double sine = q.vec().norm();
    const double w = std::abs(q.w());
    // atan2 keeps small rotations exact; a rotation and its negative quaternion are one.
    const double angle = 2 * std::atan2(sine, w);
    if (sine < 1e-300) return Eigen::Vector3d::Zero();
    return q.vec() * ((q.w() < 0 ? -angle : angle) / sine);
}

void check_same_size(const Pose& from, const Pose& to) {
    if (from.rows() != to.rows())
        throw Error("poses of " + std::to_string(from.rows()) + " and " + std::to_string(to.rows()) +
                    " joints do not mix");
}

Eigen::Matrix4d rigid_inverse(const Eigen::Matrix4d& transform) {
    Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
    inverse.topLeftCorner<3, 3>() = transform.topLeftCorner<3, 3>().transpose();
    inverse.topRightCorner<3, 1>() = -inverse.topLeftCorner<3, 3>() * transform.topRightCorner<3, 1>();
    return inverse;
}

}  // namespace

std::vector<Eigen::Matrix4d> forward_kinematics(const Body& body, const Pose& pose) {
    if (pose.rows() != body.joint_count())
        throw Error("a pose of " + std::to_string(pose.rows()) + " joints does not fit a body of " +
                    std::to_string(body.joint_count()));
    std::vector<Eigen::Matrix4d> world(body.joint.size());
    for (int j = 0; j < body.joint_count(); ++j) {
        if (!pose.row(j).allFinite()) throw Error("the rotation of joint '" + body.joint[j].name + "' is not finite");
        const Joint& joint = body.joint[j];
        world[j] =
            joint.parent < 0
                ? joint.bind
                : Eigen::Matrix4d(world[joint.parent] * (rigid_inverse(body.joint[joint.parent].bind) * joint.bind));
        const Eigen::Matrix3d rotation = from_axis_angle(pose.row(j).transpose()).toRotationMatrix();
        world[j].topLeftCorner<3, 3>() = (world[j].topLeftCorner<3, 3>() * rotation).eval();
    }
    return world;
}

std::vector<Eigen::Matrix4d> skinning_transforms(const Body& body, const Pose& pose) {
    std::vector<Eigen::Matrix4d> transform = forward_kinematics(body, pose);
    for (int j = 0; j < body.joint_count(); ++j) transform[j] = transform[j] * rigid_inverse(body.joint[j].bind);
    return transform;
}

Pose interpolate(const Pose& from, const Pose& to, double t) {
    check_same_size(from, to);
    Pose between(from.rows(), 3);
    for (int j = 0; j < from.rows(); ++j) {
        const Eigen::Quaterniond a = from_axis_angle(from.row(j).transpose());
        const Eigen::Quaterniond b = from_axis_angle(to.row(j).transpose());
        const Eigen::Vector3d step = to_axis_angle(a.conjugate() * b);
        between.row(j) = to_axis_angle(a * from_axis_angle(t * step)).transpose();
    }
    return between;
}

double largest_joint_rotation(const Pose& from, const Pose& to) {
    check_same_size(from, to);
    double largest = 0;
    for (int j = 0; j < from.rows(); ++j) {
        const Eigen::Quaterniond a = from_axis_angle(from.row(j).transpose());
        const Eigen::Quaterniond b = from_axis_angle(to.row(j).transpose());
        largest = std::max(largest, to_axis_angle(a.conjugate() * b).norm());
    }
    return largest;
}

}  // namespace toile::skin
