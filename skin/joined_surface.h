#pragma once

#include <string>
#include <vector>

#include "cloth/types.h"
#include "files/rigged_file.h"
#include "skin/bind_skeleton.h"
#include "skin/body.h"

namespace toile::skin {

/// The skinned meshes as one surface in bind space, welded.
struct JoinedSurface {
    Positions position;  ///< `[V x 3]` in bind space
    Triangles triangle;  ///< `[F x 3]` counter-clockwise outside
    SkinWeights weight;  ///< joints index `BindSkeleton::joint`; heaviest first
    std::vector<std::string> remarks;
};

/// Joins the meshes, welds vertices of the same position and influences, drops vertices without a triangle, turns the
/// surface outside out if it is inside out, and closes its holes. Throws Error naming `where` and the vertex for
/// weights that are negative, missing or do not sum to one (within 0.002, or what stored integers round off; then
/// normalised).
JoinedSurface join_surface(const files::RiggedFile& file, const std::vector<int>& mesh, const BindSkeleton& skeleton,
                           const std::string& where);

}  // namespace toile::skin
