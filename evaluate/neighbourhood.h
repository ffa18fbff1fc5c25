#pragma once

#include <string>
#include <vector>

#include "evaluate/strain_rest.h"

namespace toile::evaluate {

/// Which vertices around a vertex its strain is fitted to: those within so many rings of triangles, within a distance,
/// or the nearest. Distances are straight ones at rest; the neighbourhood is walked over edges, so that a sheet that
/// lies close by is no neighbour.
struct NeighbourhoodRule {
    enum class Kind { ring, radius, nearest };
    Kind kind = Kind::ring;
    int count = 1;      ///< rings, or the number of nearest vertices, those at the same distance as the last included
    double radius = 0;  ///< [m]
    std::string text() const;  ///< "ring:1"
};

/// "ring:2", "radius:0.03" [m] or "nearest:12". Throws Error for anything else.
NeighbourhoodRule neighbourhood_rule(const std::string& text);

/// Of each vertex its point at rest, the neighbourhood's centre, and the points of the neighbourhood, the centre first,
/// then in rising order. At a seam the panel is taken in which the neighbourhood is largest. -1 and no points for a
/// vertex without a triangle.
struct Neighbourhoods {
    std::vector<int> centre;  ///< `[V]`
    std::vector<int> offset;  ///< `[V + 1]`
    std::vector<int> point;
};

/// Throws Error where the neighbourhoods together have more than 2e7 points.
Neighbourhoods find_neighbourhoods(const StrainRest& rest, const NeighbourhoodRule& rule, int jobs);

}  // namespace toile::evaluate
