#pragma once

#include <span>

#include "bench/stress.h"

namespace toile::bench {

/// Projects the samples of a problem with the quasistatic prior, computes their residuals again, and checks the
/// derivatives by r̂, μ and the stiffnesses together where the problem asks for it.
void solve_quasistatic(const StressProblem& problem, std::span<StressOutcome> outcome);

}  // namespace toile::bench
