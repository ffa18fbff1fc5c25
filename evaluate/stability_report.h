#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"

namespace toile::evaluate {

/// The suites as text: a line for each drape; for each kind of prediction and prior what became of it, and a line for
/// each sample that failed; then what each solver passed.
std::string stability_table(const std::vector<StabilityOutcome>& outcomes);

/// What the suite left behind.
struct StabilitySummary {
    std::vector<StabilityOutcome> outcome;
    std::vector<std::string> path;  ///< of the files written

    bool passed() const;  ///< all of them
};

/// Runs the suites and writes stability.csv, stability.json and, where anything was draped, stability.png into
/// `folder`, each whole or not at all, and into `folder`/stability_replay what runs each failing case again; what
/// earlier passes left there of cases that are no longer in the table, or pass now, is removed. Numbers that were not
/// measured are empty in the CSV and null in the JSON. Throws Error before any work where the folder cannot be used.
StabilitySummary evaluate_stability(const StabilityOptions& options, const std::string& folder);

}  // namespace toile::evaluate
