#pragma once

#include <vector>

#include "simulate/crossings.h"

namespace toile::simulate {

/// A curve along which a surface crosses itself, from crossing to crossing. On the surface it is two curves, one on
/// each of the two sheets that cross; they are one where the sheets are neighbours (an armpit beside its seam).
struct Contour {
    std::vector<int> crossing;     ///< rows of the list it was traced from, rising
    std::vector<bool> of_second;   ///< of each of them: the edge is the second sheet's, the triangle the first one's
    std::vector<int> loop_vertex;  ///< where the contour ends because both sheets meet there
};

/// Chains crossings to contours: two that belong to the same pair of triangles are the ends of one piece of contour.
std::vector<Contour> trace_contours(const Triangles& triangle, const Topology& topology,
                                    const std::vector<Crossing>& crossing);

}  // namespace toile::simulate
