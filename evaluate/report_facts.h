#pragma once

#include <string>
#include <vector>

#include "evaluate/report_document.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// What is told about the evaluations, as the report's facts: once where all that tell it agree, else once a kind.
std::vector<ReportFact> report_facts(const std::vector<files::MetricFile>& evaluations);

/// What several evaluations tell under a name; the first that tells it. Empty where none does.
std::string told_about(const std::vector<files::MetricFile>& evaluations, const std::string& name);

}  // namespace toile::evaluate
