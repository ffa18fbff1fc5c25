#pragma once

#include <string>

#include "evaluate/accuracy_figures.h"
#include "evaluate/cloth_quantities.h"

namespace toile::evaluate {

/// The simulator's own error in each quantity, from noise.h5: each variant's drapes are judged as predictions of the
/// configured drapes, over the samples that both brought within the gate, and the largest of the variants counts. Of a
/// quantity that says what a cloth is like, the error is the mean difference of the two drapes. Penetration stays
/// unknown. Throws Error for a file that cannot be read, is of another mesh, or has no pair of drapes.
NoiseFloor read_noise_floor(const std::string& path, const ClothJudge& judge);

}  // namespace toile::evaluate
