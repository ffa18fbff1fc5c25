#pragma once

#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"

namespace toile::simulate {

/// The thickness that each feature of a cloth has against other features of the same cloth [m]: the wanted one, less on
/// triangles whose least height is below twice that, so that a fine mesh at rest does not touch itself. A vertex has
/// the least of its triangles, triangles and edges that of their vertices; a pair of features keeps the lesser of the
/// two.
struct FeatureThickness {
    Eigen::VectorXd vertex;    ///< `[V]`
    Eigen::VectorXd triangle;  ///< `[F]`
    Eigen::VectorXd edge;      ///< `[E]`
};

/// `rest_length` `[E]` as `edge_rest_lengths` gives it, `thickness` in metres.
FeatureThickness feature_thickness(const ClothMesh& mesh, const Topology& topology, const Eigen::VectorXd& rest_length,
                                   double thickness);

}  // namespace toile::simulate
