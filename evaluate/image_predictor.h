#pragma once

#include "evaluate/predictor.h"

namespace toile::evaluate {

/// The displacement read back from the sample's own image, as a network would have it that predicts images without any
/// error: what the image alone costs. Nothing is fitted. Throws Error for a data set without images, or whose pattern
/// does not lie in them.
std::unique_ptr<Predictor> make_image_predictor(const PredictorData& data);

}  // namespace toile::evaluate
