#pragma once

#include <vector>

#include "cloth/topology.h"
#include "cloth/types.h"

namespace toile::simulate {

struct UntangleOptions {
    int max_iterations = 200;   ///< at least 1; the budget of all phases together
    double separation = 1e-4;   ///< what is left between sheets that crossed, where there is room [m]; >= 0
    double largest_step = 0.5;  ///< largest move of a vertex in one push, in mean edge lengths; in (0, 1]
    double max_stretch = 0.1;   ///< how far an edge may stretch, of its length at the start; > 0
    double max_shrink = 0.5;    ///< how far it may shrink before the surface is smoothed; in (0, 1). Small values
                                ///< lead to more rounds and wider moves

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
    double gap = 0.0;           ///< if untangled: between what moved and the rest, at most the separation [m]
};

/// Moves the vertices of a slightly crossing mesh by little until no edge crosses a triangle.
///
/// Each round lists the crossings exactly, pushes what went through back through the surface, ring by ring
/// (`ContourPush`), draws the neighbours along and holds edges near the lengths they had. Where that leads no further
/// the surface around the crossings is smoothed. Between what crossed a gap of `separation` is left, where there
/// is room.
///
/// `x` `[V x 3]` [m] is read and written; vertices in `pinned` do not move. The result depends on the arguments alone.
/// Throws Error for positions that are not finite, pins out of range or bad options.
UntangleReport untangle(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                        const UntangleOptions& options, Positions& x);

}  // namespace toile::simulate
