#pragma once

#include <vector>

#include "evaluate/strain_rate.h"
#include "evaluate/triangle_strain.h"
#include "evaluate/vertex_strain.h"
#include "files/strain_file.h"

namespace toile::evaluate {

/// Strain and rates of a frame as its file holds them; with `stretches_only` without gradients, rotations, directions.
files::StrainColumns strain_columns(const std::vector<TriangleStrain>& strain, bool stretches_only);
files::StrainColumns strain_columns(const std::vector<VertexStrain>& strain, bool stretches_only);
files::RateColumns rate_columns(const std::vector<StrainRate>& rates, bool stretches_only);

}  // namespace toile::evaluate
