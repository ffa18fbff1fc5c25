#pragma once

#include <optional>
#include <string>

#include "cloth/types.h"

namespace toile::files {

/// A triangle mesh as a file holds it, all of its parts joined: positions may be repeated along texture seams.
struct MeshData {
    Positions position;      ///< `[N x 3]` in the file's unit
    Triangles triangle;      ///< `[F x 3]`
    PlanePositions texture;  ///< `[N x 2]` or empty
    std::vector<int> part;   ///< `[F]` index of the file's mesh each triangle came from
    std::vector<std::string> part_name;
};

/// Reads OBJ, PLY, glTF and whatever else assimp reads; node transforms are applied. Throws Error for a missing, empty,
/// truncated or unreadable file, one without faces, or with positions that are not finite.
MeshData read_mesh(const std::string& path);

/// Writes .obj, .ply or .glb by the path's extension, to a new name first, then renamed.

void write_mesh(const std::string& path, const Triangles& triangle, const Positions& position);

}  // namespace toile::files
