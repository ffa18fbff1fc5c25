#pragma once

#include <span>

#include "evaluate/stress.h"

namespace toile::evaluate {

/// Projects the samples of a problem with the inextensibility prior, computes their residuals again, and checks the
/// derivatives where the problem asks for it.
void solve_inextensibility(const StressProblem& problem, StressRoute route, std::span<StressOutcome> outcome,
                           StressSolution& kept);

}  // namespace toile::evaluate
