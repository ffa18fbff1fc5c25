#include "simulate/feature_thickness.h"

#include <algorithm>

#include "cloth/membrane.h"

namespace toile::simulate {
namespace {

/// Share of a triangle's least height that its thickness may have.
constexpr double size_share = 0.5;

}  // namespace

FeatureThickness feature_thickness(const ClothMesh& mesh, const Topology& topology, const Eigen::VectorXd& rest_length,
                                   double thickness) {
    FeatureThickness found{Eigen::VectorXd::Constant(mesh.vertex_count(), thickness),
                           Eigen::VectorXd::Constant(mesh.triangle_count(), thickness),
                           Eigen::VectorXd::Constant(topology.edge.rows(), thickness)};
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        double longest = 0.0;
        for (int c = 0; c < 3; ++c) longest = std::max(longest, rest_length[topology.triangle_edge(f, c)]);
        const double height = 2.0 * membrane_stencil(mesh, f).area / longest;
        for (int c = 0; c < 3; ++c) {
            double& vertex = found.vertex[mesh.triangle(f, c)];
            vertex = std::min(vertex, size_share * height);
        }
    }
    // What lies beyond a sliver is as near as the sliver is thin: all that meets one has to be as thin.
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int c = 0; c < 3; ++c) found.triangle[f] = std::min(found.triangle[f], found.vertex[mesh.triangle(f, c)]);
    for (int e = 0; e < topology.edge.rows(); ++e)
        found.edge[e] = std::min(found.vertex[topology.edge(e, 0)], found.vertex[topology.edge(e, 1)]);
    return found;
}

}  // namespace toile::simulate
