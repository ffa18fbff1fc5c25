#pragma once

#include <optional>
#include <string>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// What `toile evaluate accuracy` left in a folder, as a section of the report: a table for each split (paper, Tables
/// 1-4), errors against μ and against the limit (Figures 7 and 9), energies before and after (Figure 5), histograms of
/// the samples' errors (from accuracy.h5, where it lies beside), and what the differences amount to. Nothing where the
/// folder has no accuracy.json. Throws Error where it cannot be read, or is of another version.
std::optional<ReportSection> accuracy_section(const std::string& folder);

}  // namespace toile::evaluate
