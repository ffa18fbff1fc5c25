#pragma once

#include <Eigen/Geometry>

#include "skin/body.h"

namespace toile::skin::testing_support {

/// Two joints with turned bind frames, one above the other, and a strip of vertices that goes from one to the other.
inline Body two_bones() {
    Body body;
    Eigen::Affine3d lower = Eigen::Affine3d::Identity(), upper = Eigen::Affine3d::Identity();
    lower.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    lower.translation() << 0.1, 0.2, 0.3;
    upper.linear() = Eigen::AngleAxisd(-1.1, Eigen::Vector3d(3, -1, 1).normalized()).toRotationMatrix();
    upper.translation() << 0.1, 0.7, 0.3;
    body.joint = {{"lower", -1, lower.matrix()}, {"upper", 0, upper.matrix()}};
    body.rest_position.resize(5, 3);
    body.rest_position << 0, 0.2, 0.3, 0.2, 0.4, 0.3, 0, 0.6, 0.3, 0.2, 0.8, 0.4, 0, 1.0, 0.3;
    body.triangle.resize(3, 3);
    body.triangle << 0, 1, 2, 1, 3, 2, 2, 3, 4;
    body.weight.offset = {0, 1, 3, 5, 7, 8};
    body.weight.joint = {0, 0, 1, 0, 1, 1, 0, 1};
    body.weight.value = {1, 0.75, 0.25, 0.5, 0.5, 0.75, 0.25, 1};
    return body;
}

}  // namespace toile::skin::testing_support
