#pragma once

#include "evaluate/predictor.h"

namespace toile::evaluate {

/// The displacement of the train sample whose pose is nearest: the least Σ_j α_j² over the joints that vary in the
/// train split, α_j the angle between the two rotations of joint j. Of equally near ones, the sample with the lowest
/// id. Keeps poses in memory, four numbers a joint and train sample, and reads the displacement from the data set when
/// it is asked for.
std::unique_ptr<Predictor> fit_nearest(const PredictorData& data);

}  // namespace toile::evaluate
