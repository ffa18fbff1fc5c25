#pragma once

#include <string>
#include <vector>

#include "cloth/types.h"
#include "skin/surface_query.h"

namespace toile::pattern {

/// Which triangles have to be turned over `[F]` so that all of a connected piece run the same way round and outwards:
/// away from `body` where there is one, else away from the piece's middle (a flat piece keeps what most of it has).
/// Throws Error (where = `where`) naming the edge for edges with more than two triangles and for pieces that have no
/// two sides (a Moebius band).
std::vector<bool> triangles_to_turn(const Triangles& triangle, const Positions& position,
                                    const skin::SurfaceQuery* body, const std::string& where);

}  // namespace toile::pattern
