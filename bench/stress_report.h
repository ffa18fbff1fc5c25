#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "bench/stress.h"

namespace toile::bench {

/// One line for each kind of prediction and prior: how many met their tolerance, the worst residual over its
/// tolerance, the most iterations, time; then derivatives; then every sample that fell short.
void print_stress(std::ostream& out, const std::vector<StressOutcome>& outcome);

/// The samples that fell short, as JSON: enough to run each again by `--only`. Throws Error if it cannot be written.
void write_failures(const std::vector<StressOutcome>& outcome, const std::string& file);

/// Something said it had converged, or that its derivative is accurate, and it is not so.
bool any_false_claim(const std::vector<StressOutcome>& outcome);

}  // namespace toile::bench
