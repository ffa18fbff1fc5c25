#pragma once

#include <algorithm>

#include "skin/body.h"
#include "skin/pose.h"
#include "skin/surface_extraction.h"

namespace toile::test {

/// An upright pillar of radius 0.1 m and height 1 m on the ground with two joints, at the ground and half way up; the
/// weights pass over between 0.4 and 0.6 m.
inline skin::Body pillar_body() {
    const auto distance = [](const Eigen::Vector3d& p) {
        const Eigen::Vector3d on_axis(0.0, std::clamp(p.y(), 0.1, 0.9), 0.0);
        return (p - on_axis).norm() - 0.1;
    };
    const auto surface = skin::extract_surface(distance, {-0.15, -0.05, -0.15}, {0.15, 1.05, 0.15}, 0.012);
    skin::Body body;
    body.rest_position = surface.position;
    body.triangle = surface.triangle;
    Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
    body.joint.push_back({"lower", -1, bind});
    bind(1, 3) = 0.5;
    body.joint.push_back({"upper", 0, bind});
    for (int v = 0; v < body.vertex_count(); ++v) {
        const double upper = std::clamp((body.rest_position(v, 1) - 0.4) / 0.2, 0.0, 1.0);
        body.weight.offset.push_back(2 * v);
        body.weight.joint.insert(body.weight.joint.end(), {0, 1});
        body.weight.value.insert(body.weight.value.end(), {1.0 - upper, upper});
    }
    body.weight.offset.push_back(2 * body.vertex_count());
    return body;
}

/// The upper half bent sideways by `angle` [rad].
inline skin::Pose bent(double angle) {
    skin::Pose pose = skin::Pose::Zero(2, 3);
    pose(1, 2) = angle;
    return pose;
}

}  // namespace toile::test
