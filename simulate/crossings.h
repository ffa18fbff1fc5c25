#pragma once

#include <vector>

#include "cloth/topology.h"
#include "cloth/types.h"

namespace toile::simulate {

/// An edge of the mesh that meets one of its triangles, with which it shares no vertex.
struct Crossing {
    int edge, triangle;  ///< rows of `Topology::edge` and of the triangles
};

/// All crossings of the mesh with itself at `position` `[V x 3]`, decided by exact predicates (CGAL), sorted by edge,
/// then triangle. Touching counts. Two triangles that share at most one vertex intersect beyond it if and only if an
/// edge of one crosses the other, so an empty list is the proof that nothing intersects but triangles without area and
/// neighbours folded flat onto each other (`count_self_intersections` counts those too). The mesh may be of any
/// topology. Throws Error for positions that are not finite.
std::vector<Crossing> find_crossings(const Triangles& triangle, const Topology& topology, const Positions& position);

}  // namespace toile::simulate
