#pragma once

#include <string>

#include "cloth/types.h"

namespace toile::files {

/// Checks an OBJ file line by line for what assimp passes over in silence or reports without a line. Throws Error with
/// `path:line` for a coordinate that is missing, no number or not finite, a face with a corner that is not there (of
/// positions or texture coordinates), and a vertex that belongs to no face. Internal to files/.
void check_obj_text(const std::string& path);

/// What the lines of an OBJ file say of its shape: all vertices in their order, in double precision, and the faces in
/// theirs, cut into triangles from their first corner. Checked as above, but that vertices need no face.
struct ObjShape {
    Positions position;  ///< `[V x 3]`
    Triangles triangle;  ///< `[F x 3]`
};
ObjShape read_obj_shape(const std::string& path);

}  // namespace toile::files
