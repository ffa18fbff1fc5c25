#pragma once

#include <string>

namespace toile::files {

/// Checks the header of a PLY file line by line: assimp reads on for ever where a line is none of the format's. Throws
/// Error for such a line, and for a header without an end. Internal to files/.
void check_ply_header(const std::string& path);

}  // namespace toile::files
