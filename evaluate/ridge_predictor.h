#pragma once

#include "evaluate/predictor.h"

namespace toile::evaluate {

/// Principal components of displacement (displacement_components.h), each by ridge regression (ridge_regression.h) on
/// the rotation matrices of the joints that vary in the train split: d̂ = d̄ + P W (x − x̄). Three passes over the train
/// split; memory does not grow with it.
std::unique_ptr<Predictor> fit_ridge_predictor(const PredictorOptions& options, const PredictorData& data);

}  // namespace toile::evaluate
