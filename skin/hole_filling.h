#pragma once

#include "cloth/types.h"

namespace toile::skin {

struct FilledHoles {
    Triangles triangle;  ///< the surface's triangles, then those of the fillings
    int filled = 0;      ///< holes closed
    int open = 0;        ///< holes left open: their edge runs through one vertex twice, or no filling was found
};

/// Closes the holes of a surface with triangles between the vertices of each boundary loop, no vertices added (CGAL's
/// minimum-weight triangulation, Liepa 2003). The fillings are wound like the surface around them.
FilledHoles fill_holes(const Triangles& triangle, const Positions& position);

}  // namespace toile::skin
