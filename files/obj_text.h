#pragma once

#include <string>

namespace toile::files {

/// Checks an OBJ file line by line for what assimp passes over in silence or reports without a line. Throws Error with
/// `path:line` for a coordinate that is missing, no number or not finite, a face with a corner that is not there (of
/// positions or texture coordinates), and a vertex that belongs to no face. Internal to files/.
void check_obj_text(const std::string& path);

}  // namespace toile::files
