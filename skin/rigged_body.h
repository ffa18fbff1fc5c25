#pragma once

#include <map>
#include <string>
#include <vector>

#include "skin/body.h"

namespace toile::skin {

struct RiggedBodyOptions {
    std::string up = "auto";           ///< axis of the stored positions that points up: auto, x, y, z, -x, -y or -z
    double metres_per_unit = 0;        ///< length of one unit of the stored positions [m]; 0: found out
    std::map<Role, std::string> role;  ///< joint names for roles; the others are found by name and place
    std::vector<std::string> mesh;     ///< names of the meshes to join; empty: all that have a skin
};

struct RiggedBody {
    Body body;
    std::vector<std::string> remarks;  ///< what was found out, mended or is missing, one sentence each
};

/// Reads a rigged body from any file `files::read_rigged_file` reads, and brings it to metres, y up, facing +z. It is
/// not moved: the origin stays where the file's bind pose has it.
///
/// The bind pose comes from the skin's offset matrices alone. All skinned meshes are joined; vertices that the file
/// repeats along texture seams (same position, same influences) are welded; all influences are kept; holes of the
/// surface are closed with triangles that come after the file's own. Bind transforms
/// lose their scale, so the body follows G_j = G_parent (B_parent^-1 B_j) R(θ_j) with rigid B_j.
///
/// Throws Error naming the file, and vertex or joint, for weights that are negative, missing or do not sum to one
/// (within 0.002, then normalised), a role given to a joint that is absent, an unknown mesh name, and what
/// `files::read_rigged_file` refuses.
RiggedBody read_rigged_body(const std::string& path, const RiggedBodyOptions& options = {});

}  // namespace toile::skin
