#pragma once

#include <string>

#include "generate/scene_config.h"
#include "simulate/drape.h"

namespace toile::generate {

/// A mesh file that can be written, checked before any work: throws Error for another extension or a folder that is not
/// there.
void check_mesh_path(const std::string& path);

/// Writes the body in pose `number` as .obj, .ply or .glb. Throws Error for a scene without [body] or a pose that it
/// does not have.
void write_posed_body(const SceneConfig& config, int number, const std::string& path);

/// Drapes the garment once and writes it as .obj, .ply or .glb: in the neutral pose (or in a scene without a body)
/// where `number` is -1, else in that pose. Numerical failures are in the result's status; the mesh is written all the
/// same unless it is not finite.
simulate::DrapeResult simulate_once(const SceneConfig& config, int number, const std::string& path);

}  // namespace toile::generate
