#pragma once

#include <span>

#include "evaluate/stress.h"

namespace toile::evaluate {

/// Projects the samples of a problem with the quasistatic prior, computes their residuals again, and checks the
/// derivatives by r̂, μ and the stiffnesses together where the problem asks for it.
void solve_quasistatic(const StressProblem& problem, StressRoute route, std::span<StressOutcome> outcome,
                       StressSolution& kept);

}  // namespace toile::evaluate
