#pragma once

#include <string>

#include "cloth/types.h"

namespace toile::files {

/// A mesh just as its file lists it: every vertex in its place and in double precision, none joined, parted or left
/// out, so that vertex k of one file is vertex k of the next. (`read_mesh` joins vertices that coincide.)
struct MeshFrame {
    Positions position;  ///< `[V x 3]` in the file's unit, finite
    Triangles triangle;  ///< `[F x 3]` polygons are cut into triangles from their first corner
};

/// Reads .obj or .ply (text and binary). Texture coordinates, normals, colours, groups and materials are passed over.
/// Throws Error for another extension, a missing, damaged or truncated file, one without faces, and for positions that
/// are not finite.
MeshFrame read_mesh_frame(const std::string& path);

}  // namespace toile::files
