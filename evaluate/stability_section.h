#pragma once

#include <optional>
#include <string>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// What stability.json of a folder of results says: counts by solver, then one table of the cases, failing ones first.
/// Of cases that passed it shows no more than a thousand; the rest are counted in the note. Nothing where there is no
/// such file; throws Error where it cannot be read.
std::optional<ReportSection> stability_section(const std::string& folder);

}  // namespace toile::evaluate
