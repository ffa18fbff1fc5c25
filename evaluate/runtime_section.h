#pragma once

#include <optional>
#include <string>

#include "evaluate/report_document.h"

namespace toile::evaluate {

/// The report's section on error against run time, from `folder`/runtime.json; nothing where there is none or it holds
/// metrics alone. Throws Error where it cannot be read or is of another version.
std::optional<ReportSection> runtime_section(const std::string& folder);

}  // namespace toile::evaluate
