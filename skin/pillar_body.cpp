#include "skin/pillar_body.h"

#include <algorithm>

#include "skin/surface_extraction.h"

namespace toile::skin {

Body pillar_body() {
    constexpr double radius = 0.1, height = 1.0;
    const auto distance = [=](const Eigen::Vector3d& p) {
        const Eigen::Vector3d on_axis(0.0, std::clamp(p.y(), radius, height - radius), 0.0);
        return (p - on_axis).norm() - radius;
    };
    const auto surface = extract_surface(distance, {-0.15, -0.05, -0.15}, {0.15, 1.05, 0.15}, 0.012);
    Body body;
    body.rest_position = surface.position;
    body.triangle = surface.triangle;
    Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
    body.joint.push_back({"lower", -1, bind});
    bind(1, 3) = 0.5 * height;
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

Pose bent_pillar(double angle) {
    Pose pose = Pose::Zero(2, 3);
    pose(1, 2) = angle;
    return pose;
}

}  // namespace toile::skin
