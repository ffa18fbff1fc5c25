#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cloth/types.h"

namespace toile::files {

/// A triangle mesh as a file holds it, all of its parts joined. Vertices with the same position and texture coordinates
/// are one; positions are repeated along texture seams.
struct MeshData {
    Positions position;      ///< `[N x 3]` in the file's unit
    Triangles triangle;      ///< `[F x 3]`
    PlanePositions texture;  ///< `[N x 2]` or empty
    std::vector<int> part;   ///< `[F]` index of the file's mesh each triangle came from
    std::vector<std::string> part_name;
};

/// Reads OBJ, PLY, glTF and whatever else assimp reads; node transforms are applied, polygons are cut into triangles.
/// Throws Error for a missing, empty, truncated or unreadable file, one without faces, or with positions that are not
/// finite; for OBJ also, with the line, a vertex without a face and a corner that is not there. Elsewhere vertices
/// without a face are kept.
MeshData read_mesh(const std::string& path);

/// One mesh of a file of several.
struct NamedMesh {
    std::string name;
    Triangles triangle;                          ///< `[F x 3]`
    Positions position;                          ///< `[V x 3]` [m]
    Eigen::Vector3f color = {0.7f, 0.7f, 0.7f};  ///< linear red, green, blue in [0, 1]; .glb only
    PlanePositions texture = {};                 ///< `[P x 2]` or empty; .obj and .ply only
    Triangles texture_triangle = {};             ///< `[F x 3]` texture indices of each triangle's corners
    Positions vertex_color = {};                 ///< `[V x 3]` sRGB in [0, 1] or empty; .ply and .glb only
};

/// Writes .obj, .ply or .glb by the path's extension, to a new name first, then renamed. Vertices keep their order and
/// count. .obj (12 decimals) and .ply (float64) keep positions to 1e-12 m, .glb to float32; .glb carries vertex normals
/// and colours. Texture coordinates belong to corners, so that a seam does not part the mesh: `vt` in .obj, the face
/// property `texcoord` in .ply (six floats). Throws Error for another extension, indices or positions no file can hold,
/// or a failed write.
void write_meshes(const std::string& path, const std::vector<NamedMesh>& meshes);
void write_mesh(const std::string& path, const Triangles& triangle, const Positions& position);

}  // namespace toile::files
