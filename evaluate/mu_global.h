#pragma once

#include <functional>

#include "evaluate/mu_fit.h"
#include "evaluate/mu_loss.h"

namespace toile::evaluate {

/// The best global μ on all samples of `loss`: `mu`, `status` and `history` of the fit. `scan` holds a few of the
/// samples. `evaluated` is called before each evaluation; it may throw. Raises `left_out` to the most samples that an
/// evaluation left out.
MuGlobalFit fit_global_mu(MuLoss& loss, MuLoss& scan, const MuFitOptions& options, double unit,
                          const std::function<void()>& evaluated, int& left_out);

}  // namespace toile::evaluate
