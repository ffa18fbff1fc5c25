#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// What became of the cases of one solver, or of one of its groups.
struct StabilityTally {
    std::string solver, group;  ///< group: empty for all of them
    int cases = 0, passed = 0, finite = 0, rests = 0, falling = 0;
    int false_claims = 0;
    int derivatives = 0, accurate_derivatives = 0;  ///< tried, and accurate to 1e-9
    double worst_residual = 0;                      ///< over its tolerance, of samples that say they converged
    double worst_identity = 0;                      ///< of derivatives that say they are accurate
    double seconds = 0, slowest = 0;                ///< [s]
    bool prior = false;

    void add(const StabilityOutcome& one);
};

/// By solver, in the order of their first case.
std::vector<StabilityTally> tally_by_solver(const std::vector<StabilityOutcome>& outcomes);
/// By solver and group.
std::vector<StabilityTally> tally_by_group(const std::vector<StabilityOutcome>& outcomes);

/// "stability/<solver>/passed_share" [%], "…/false_claims", "…/not_finite", and the time, which is told but not judged.
std::vector<files::Metric> stability_metrics(const std::vector<StabilityOutcome>& outcomes);

}  // namespace toile::evaluate
