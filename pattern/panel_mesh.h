#pragma once

#include "cloth/types.h"

namespace toile::pattern {

/// A flat panel of cloth: triangles counter-clockwise in the pattern plane.
struct PanelMesh {
    PlanePositions position;  ///< `[P x 2]` the boundary first, in the order given, then the inside [m]
    Triangles triangle;       ///< `[F x 3]`
};

/// Fills a simple polygon with nearly equilateral triangles of about `edge_length` [m]. The corners of `boundary`
/// `[N x 2]` (counter-clockwise, already cut into pieces of about that length) are kept as they are and none is added
/// between them, so that panels can be sewn point by point. The inside starts from a hexagonal lattice and is evened
/// out by Lloyd's iteration under a constrained Delaunay triangulation (CGAL Mesh_2). Throws Error where the polygon
/// crosses itself.
PanelMesh mesh_panel(const PlanePositions& boundary, double edge_length);

}  // namespace toile::pattern
