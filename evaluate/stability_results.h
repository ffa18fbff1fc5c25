#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"

namespace toile::evaluate {

/// The outcomes as text for programs. Numbers that were not measured are null in the JSON and empty in the
/// comma-separated values, whose columns are the JSON's fields.
std::string stability_json(const std::vector<StabilityOutcome>& outcomes);
std::string stability_csv(const std::vector<StabilityOutcome>& outcomes);

/// What `stability_json` wrote to a file. Throws Error for anything else.
std::vector<StabilityOutcome> read_stability_results(const std::string& path);

}  // namespace toile::evaluate
