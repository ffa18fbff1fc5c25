#pragma once

#include <functional>

#include "evaluate/mu_fit.h"
#include "evaluate/mu_loss.h"
#include "evaluate/mu_smoothing.h"

namespace toile::evaluate {

/// μ per vertex from the global one, for each weight of the smoothness term in turn (`MuVertexFit`, but for its errors
/// of predictions and reference). `chosen_by` holds the samples that choose the weight; without samples the stiffest
/// weight is taken. `evaluated` and `left_out` as in `fit_global_mu`.
MuVertexFit fit_vertex_mu(MuLoss& loss, MuLoss& chosen_by, const MuSmoothing& smoothing, const MuFitOptions& options,
                          double global_mu, double unit, const std::function<void()>& evaluated, int& left_out);

}  // namespace toile::evaluate
