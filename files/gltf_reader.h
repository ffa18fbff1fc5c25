#pragma once

#include <string>

#include "files/rigged_file.h"

namespace toile::files {

/// Whether `path` is glTF, text or binary, by its first bytes or its extension.
bool is_gltf(const std::string& path);

/// Reads the scene of a glTF 2.0 file, with or without skins: each primitive of each node that shows a mesh. Apart from
/// the other formats because assimp 5.2 misreads weights stored as integers (its issues 4587, 6130) and crashes on a
/// skin without bind matrices (3465). Internal to files/; throws as `read_rigged_file` does.
RiggedFile read_gltf(const std::string& path);

}  // namespace toile::files
