#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// What each kind of case promises, and is judged by.
inline constexpr const char* simulator_promise =
    "every drape at rest within the gate, every position finite, energy never rising on the way to rest";
inline constexpr const char* prior_promise =
    "status converged, every position finite, the residual computed again from the positions within the tolerance, and "
    "<g, J v> = <J^T g, v> to 1e-9 where the derivative is tried; a sample that says it fell short has failed, one "
    "that "
    "claims an accuracy it does not have made a false claim";

/// Writes stability.json whole or not at all: the members of every evaluation (files/metric_file.h), `promises`, and
/// `cases`, one object a row. What was not measured, or does not apply to a row's suite, is null.
void write_stability_results(const std::string& path, const std::vector<StabilityOutcome>& outcomes,
                             const std::vector<files::MetricFile::Line>& about);

/// The rows as comma-separated values, whose columns are the JSON's fields; null is empty.
std::string stability_csv(const std::vector<StabilityOutcome>& outcomes);

/// What the former wrote. Throws Error for anything else.
std::vector<StabilityOutcome> read_stability_results(const std::string& path);

}  // namespace toile::evaluate
