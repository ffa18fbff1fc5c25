#pragma once

#include <string>

#include "cloth/types.h"
#include "skin/surface_query.h"

namespace toile::pattern {

struct PushOutOptions {
    double clearance = 0.004;  ///< distance the vertices come to have from the body [m]
    double max_push = 0.05;    ///< a vertex deeper inside than this is an error [m]
};

struct PushOutReport {
    int inside = 0;        ///< vertices that were inside the body
    int moved = 0;         ///< vertices that were moved by more than 0.1 mm
    double deepest = 0.0;  ///< [m]
    int still_near = 0;    ///< vertices left nearer than half the clearance
};

/// Moves the vertices of a surface out of the body, each to its nearest outside point, and their neighbours along with
/// them so that no crease appears. Throws Error (where = `where`) naming the deepest vertex where one is deeper inside
/// than `max_push`.
PushOutReport push_out(const Triangles& triangle, Positions& position, const skin::SurfaceQuery& body,
                       const PushOutOptions& options, const std::string& where);

}  // namespace toile::pattern
