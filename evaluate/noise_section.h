#pragma once

#include <optional>
#include <string>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// The simulator's noise floor from `folder`/noise.json: what it means in words, a table of the variants, how the
/// distances are spread. Nothing where there is no such file; Error where it cannot be read.
std::optional<ReportSection> noise_section(const std::string& folder);

}  // namespace toile::evaluate
