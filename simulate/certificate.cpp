#include "simulate/certificate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/self_intersection.h"
#include "skin/surface_query.h"

namespace toile::simulate {

std::string_view status_reason(DrapeStatus status) {
    switch (status) {
        case DrapeStatus::accepted:
            return "accepted";
        case DrapeStatus::not_at_rest:
            return "not_at_rest";
        case DrapeStatus::penetrates_body:
            return "penetrates_body";
        case DrapeStatus::overstretched:
            return "overstretched";
        case DrapeStatus::not_finite:
            return "not_finite";
        case DrapeStatus::self_intersects:
            return "self_intersects";
        case DrapeStatus::body_intersects_itself:
            return "body_intersects_itself";
        case DrapeStatus::crashed:
            return "crashed";
        case DrapeStatus::out_of_memory:
            return "out_of_memory";
    }
    return "unknown";
}

std::vector<std::string_view> status_reasons() {
    std::vector<std::string_view> reasons;
    for (int status = 0; status < drape_status_count; ++status)
        reasons.push_back(status_reason(static_cast<DrapeStatus>(status)));
    return reasons;
}

Eigen::VectorXd edge_rest_lengths(const ClothMesh& mesh, const Topology& topology) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(topology.edge.rows());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(topology.edge.rows());
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int e = topology.triangle_edge(f, corner);
            const auto p = mesh.pattern_triangle.row(f);
            sum[e] += (mesh.pattern_position.row(p[(corner + 1) % 3]) - mesh.pattern_position.row(p[(corner + 2) % 3]))
                          .norm();
            count[e] += 1.0;
        }
    }
    return sum.cwiseQuotient(count);
}

StretchRange stretch_range(const Topology& topology, const Eigen::VectorXd& rest_length, const Positions& position) {
    StretchRange range{0.0, std::numeric_limits<double>::infinity()};
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const double stretch =
            (position.row(topology.edge(e, 0)) - position.row(topology.edge(e, 1))).norm() / rest_length[e];
        range.largest = std::max(range.largest, stretch);
        range.smallest = std::min(range.smallest, stretch);
    }
    return range;
}

double body_penetration(const Triangles& body_triangle, const Positions& posed_body, const Positions& cloth,
                        const Eigen::VectorXd& level_set_distance) {
    const skin::SurfaceQuery query(body_triangle, posed_body);
    double deepest = 0.0;
    for (int v = 0; v < cloth.rows(); ++v) {
        const Eigen::Vector3d point = cloth.row(v).transpose();
        // The nearest feature's normal is right on a simple surface. Where a limb folds into the trunk, a buried
        // surface may be the nearest and its normal wrong either way: the level set, which joins the two, raises
        // suspicion, and the winding number decides.
        const double suspected = level_set_distance.size() > 0 ? -level_set_distance[v] : 0.0;
        const double depth = std::max(-query.nearest(point).signed_distance, suspected);
        if (depth > deepest && query.winding_number(point) > 0.5) deepest = depth;
    }
    return deepest;
}

}  // namespace toile::simulate
