#pragma once

#include <optional>
#include <string>

#include "files/mesh_file.h"
#include "pattern/garment.h"
#include "skin/body.h"

namespace toile::pattern {

enum class UpAxis { x, y, z };

struct GarmentFileOptions {
    double unit_scale = 1.0;     ///< metres per unit of the file's positions, 1e-6 to 1000
    UpAxis up = UpAxis::y;       ///< the file's up axis; x and z are turned onto y
    double pattern_scale = 0.0;  ///< metres per texture unit, 0 to 1000; 0: estimated from the garment in space
    double edge_length = 0.0;    ///< refine until no edge is longer [m], 0.004 to 1; 0: as it is
    double clearance = 0.004;    ///< distance from the neutral body it is pushed out to [m], 0 to 0.02
    double max_push = 0.05;      ///< deepest penetration that is pushed out [m], 0 to 0.1; a deeper one is an error
};

/// A garment from OBJ, glTF or whatever else assimp reads, with texture coordinates as its pattern. `body`, where
/// there is one, is the body in its neutral pose. Throws Error (where = `path`) as `garment_from_mesh` does, and for
/// what `files::read_mesh` refuses.
Garment read_garment(const std::string& path, const GarmentFileOptions& options, const skin::Body* body);

/// The same from a mesh already read.
///
/// - Positions are welded to the sewn connectivity: equal ones first, then those within a thousandth of the median
/// edge.
/// - Texture islands become panels, laid apart. Where an island is mirrored, u is turned round, so that pattern
/// triangles
///   run the same way as in space. The pattern is scaled by `pattern_scale`, or by the median over the triangles of
///   the ratio of lengths in space and in texture; texture coordinates that are metres already (ratio 0.9 to 1.1) are
///   kept.
/// - Winding is made consistent within each piece, and turned outwards (away from the body, else from the piece's
///   middle).
/// - Vertices inside the body or nearer than `clearance` are pushed out smoothly.
///
/// Throws Error that names vertex, edge or triangle for: no triangles, positions that are not finite, isolated
/// vertices, non-manifold edges, triangles without area in space or texture, missing texture coordinates, surfaces
/// that cannot be wound consistently, penetration deeper than `max_push`.
Garment garment_from_mesh(const files::MeshData& mesh, const GarmentFileOptions& options, const skin::Body* body,
                          const std::string& where);

}  // namespace toile::pattern
