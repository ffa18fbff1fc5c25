#pragma once

#include <span>

#include "bench/stress.h"

namespace toile::bench {

/// Projects the samples of a problem with the inextensibility prior, computes their residuals again, and checks the
/// derivatives where the problem asks for it.
void solve_inextensibility(const StressProblem& problem, std::span<StressOutcome> outcome);

}  // namespace toile::bench
