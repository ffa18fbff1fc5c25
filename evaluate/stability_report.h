#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"

namespace toile::evaluate {

/// The suite as a table of text: one line a case and solver, then what each solver passed.
std::string stability_table(const std::vector<StabilityOutcome>& outcomes);

/// What the suite left behind.
struct StabilitySummary {
    std::vector<StabilityOutcome> outcome;
    std::vector<std::string> path;  ///< of the files written

    bool passed() const;  ///< all of them
};

/// Runs the suite and writes stability.csv, stability.json and stability.png into `folder`, each whole or not at all.
/// Numbers that were not measured are empty in the CSV and null in the JSON. Throws Error before any work where the
/// folder cannot be used.
StabilitySummary evaluate_stability(const StabilityOptions& options, const std::string& folder);

}  // namespace toile::evaluate
