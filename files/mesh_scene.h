#pragma once

#include <assimp/scene.h>

#include <Eigen/Core>
#include <assimp/Importer.hpp>
#include <string>

namespace toile::files {

/// Opens `path` with assimp and returns the scene, owned by `importer`. Throws Error for a missing, empty or unreadable
/// file. Internal to files/.
const aiScene* open_scene(Assimp::Importer& importer, const std::string& path, unsigned post_processing);

/// Throws Error where `path` is missing, a folder, empty or may not be read.
void check_readable(const std::string& path);

/// Whether `path` ends in `extension` (lower case, with its dot), in any case.
bool has_extension(const std::string& path, const std::string& extension);

/// A library's message, fit for one line.
std::string one_line(std::string text);

/// assimp's row-major matrix as Eigen's.
Eigen::Matrix4d matrix_of(const aiMatrix4x4& m);

/// Throws Error if a vertex of `mesh` is not finite or a face refers to a vertex that is not there.
void check_scene_mesh(const aiMesh& mesh, const std::string& path);

}  // namespace toile::files
