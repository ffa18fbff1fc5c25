#pragma once

#include "cloth/types.h"

namespace toile::simulate {

/// Number of pairs of triangles that cross, by exact predicates (CGAL). Triangles that share a vertex or an edge count
/// only where they overlap beyond it. The mesh must be a manifold; its triangles may be of any shape.
int count_self_intersections(const Triangles& triangle, const Positions& position);

}  // namespace toile::simulate
