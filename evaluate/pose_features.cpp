#include "evaluate/pose_features.h"

#include <algorithm>
#include <cmath>

namespace toile::evaluate {
namespace {

constexpr double same_angle = 1e-9;  // [rad]

Eigen::Quaterniond rotation_of(const Eigen::RowVector3d& theta) {
    const double angle = theta.norm();
    if (angle == 0) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, theta.transpose() / angle));
}

}  // namespace

void JointRange::add(const skin::Pose& pose) {
    if (low_.rows() == 0) low_ = high_ = pose;
    low_ = low_.cwiseMin(pose);
    high_ = high_.cwiseMax(pose);
}

std::vector<int> JointRange::varying() const {
    std::vector<int> joint;
    for (int j = 0; j < static_cast<int>(low_.rows()); ++j)
        if ((high_.row(j) - low_.row(j)).maxCoeff() > same_angle) joint.push_back(j);
    return joint;
}

Eigen::VectorXd rotation_features(const skin::Pose& pose, const std::vector<int>& joint) {
    using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    Eigen::VectorXd feature(static_cast<Eigen::Index>(9 * joint.size()));
    for (size_t k = 0; k < joint.size(); ++k)
        Eigen::Map<Matrix>(feature.data() + 9 * k) =
            rotation_of(pose.row(joint[k])).toRotationMatrix() - Eigen::Matrix3d::Identity();
    return feature;
}

std::vector<Eigen::Quaterniond> joint_rotations(const skin::Pose& pose, const std::vector<int>& joint) {
    std::vector<Eigen::Quaterniond> rotation;
    rotation.reserve(joint.size());
    for (const int j : joint) rotation.push_back(rotation_of(pose.row(j)));
    return rotation;
}

double squared_pose_distance(const std::vector<Eigen::Quaterniond>& a, const std::vector<Eigen::Quaterniond>& b,
                             double bound) {
    double sum = 0;
    for (size_t j = 0; j < a.size() && sum <= bound; ++j) {
        // the chord, not the dot product: it keeps its digits where rotations are close
        const Eigen::Vector4d p = a[j].coeffs(), q = b[j].coeffs();
        const double chord = std::min((p - q).norm(), (p + q).norm());
        const double angle = 4 * std::asin(std::min(1.0, chord / 2));
        sum += angle * angle;
    }
    return sum;
}

}  // namespace toile::evaluate
