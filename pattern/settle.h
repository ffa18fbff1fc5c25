#pragma once

#include "cloth/cloth_mesh.h"
#include "skin/body.h"

namespace toile::pattern {

struct SettleOptions {
    double clearance = 0.008;  ///< distance the vertices keep from the body [m]
    int sweeps = 200;          ///< over all edges
    double bending = 0.1;      ///< pull of a vertex to its neighbours' mean in each sweep, 0 to 1
};

struct SettleReport {
    double nearest = 0.0;      ///< smallest signed distance of a vertex, edge middle or triangle middle to the body [m]
    double max_stretch = 0.0;  ///< largest edge length over rest length
    double min_stretch = 0.0;
};

/// Moves `mesh.rest_position` towards its pattern's edge lengths and out of the body: position-based sweeps, no
/// gravity. A start for a drape, not a drape.
SettleReport settle(ClothMesh& mesh, const skin::Body& body, const SettleOptions& options);

/// Rest length `[E]` of each edge of the topology: the mean of its pattern lengths over its triangles (contract).
Eigen::VectorXd pattern_edge_lengths(const ClothMesh& mesh);

}  // namespace toile::pattern
