#pragma once

#include <optional>
#include <string>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// The report's section of `folder`/strain.json: histograms of the stretches (and rates), a table of all quantities
/// with their distributions, faults, and a table by frame, of the most stretched where there are many. Nothing where
/// there is no such file; throws Error where it cannot be read or is of another version.
std::optional<ReportSection> strain_section(const std::string& folder);

}  // namespace toile::evaluate
