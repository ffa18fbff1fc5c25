#pragma once

#include <vector>

#include "cloth/topology.h"
#include "cloth/types.h"

namespace toile::simulate {

struct UntangleOptions {
    int max_iterations = 200;    ///< at least 1; the budget of all phases together
    double separation = 1e-4;    ///< what is left between sheets that crossed, where there is room [m]; >= 0
    double largest_step = 0.5;   ///< largest move of a vertex in one push, in mean edge lengths; in (0, 1]
    double length_change = 0.1;  ///< how far an edge may shrink or stretch from its length at the start; in (0, 1)

    /// Throws Error naming field, value and bound.
    void validate() const;
};

enum class UntangleStatus {
    clean,      ///< nothing crossed, nothing was moved
    untangled,  ///< nothing crosses any more
    tangled,    ///< the budget ran out; the state with the fewest crossings was kept
};

struct UntangleReport {
    UntangleStatus status = UntangleStatus::clean;
    int crossings_before = 0;   ///< edges through triangles, as `find_crossings` lists them
    int crossings_after = 0;    ///< never more than before
    int iterations = 0;         ///< searches for crossings that were followed by a move
    double largest_move = 0.0;  ///< of a vertex [m]
};

/// Moves the vertices of a slightly crossing mesh by as little as it takes until no edge crosses a triangle.
///
/// Each round lists the crossings exactly, chains them to contours and finds the pieces of surface that went through
/// (Baraff, Witkin, Kass: Untangling cloth, 2003). The ends of crossing edges that lie on such a piece are pushed back
/// through the triangle, ring by ring; an edge whose contour cuts nothing off moves the way its contour gets shorter
/// (Volino, Magnenat-Thalmann: Resolving surface collisions through intersection contour minimization, 2006). The move
/// is then faired into the surroundings, and edges are held near the lengths they had.
///
/// `x` `[V x 3]` [m] is read and written; vertices in `pinned` do not move. The result depends on the arguments alone.
/// Throws Error for positions that are not finite, pins out of range or bad options.
UntangleReport untangle(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                        const UntangleOptions& options, Positions& x);

}  // namespace toile::simulate
