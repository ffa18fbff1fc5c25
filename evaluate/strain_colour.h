#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "evaluate/triangle_strain.h"

namespace toile::evaluate {

/// White at a stretch of 1, red from 1.25 on, blue up to 0.75; grey where there is none (NaN). sRGB in [0, 1].
Eigen::RowVector3d stretch_colour(double stretch);

/// Of each vertex `[V]` the mean over its triangles, by rest area, of the principal stretch that is further from 1; NaN
/// where none of them has values.
Eigen::VectorXd shown_stretch(const StrainRest& rest, const std::vector<TriangleStrain>& strain);

/// Writes the mesh with a colour at each vertex, as .ply or .glb. Throws Error.
void write_coloured_mesh(const std::string& path, const StrainRest& rest, const Positions& position,
                         const std::vector<TriangleStrain>& strain);

}  // namespace toile::evaluate
