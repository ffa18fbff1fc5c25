#pragma once

#include "evaluate/predictor.h"

namespace toile::evaluate {

/// The train split's mean displacement, whatever the pose: what carrying the cloth with the body alone is worth.
std::unique_ptr<Predictor> fit_mean(const PredictorData& data);

}  // namespace toile::evaluate
