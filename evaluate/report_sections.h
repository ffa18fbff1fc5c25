#pragma once

#include <string>
#include <vector>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// The sections of all evaluations that left results in the folder, in the report's order, made by their owners
/// (`<kind>_section.h`). Throws Error where results cannot be read or are of another version.
std::vector<ReportSection> report_sections(const std::string& folder);

}  // namespace toile::evaluate
