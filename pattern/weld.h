#pragma once

#include <vector>

#include "cloth/types.h"

namespace toile::pattern {

/// The number of the welded vertex for each row of `position` `[N x 3]`, numbered in order of first appearance: rows at
/// exactly the same place are one, and rows within `tolerance` [the unit of `position`] of each other. `vertex_count`
/// is set to the number of welded vertices.
std::vector<int> weld_positions(const Positions& position, double tolerance, int& vertex_count);

/// Median length of the triangles' sides; 0 where there is none.
double median_edge(const Triangles& triangle, const Positions& position);

}  // namespace toile::pattern
