#pragma once

#include "pattern/garment.h"

namespace toile::pattern {

/// Divides a garment's triangles until no edge is longer than `edge_length` [m] in the pattern: each triangle at its
/// longest edge first (Rivara 1984), so that angles stay above half the smallest there was, and without hanging
/// vertices. Space and pattern are divided together; an edge on a seam gets one new vertex and a pattern position in
/// each panel. Throws Error where that takes more than `max_triangles`.
void refine(Garment& garment, double edge_length, int max_triangles = 400000);

}  // namespace toile::pattern
