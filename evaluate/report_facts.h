#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/accuracy_document.h"
#include "evaluate/report_document.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// What is told about the evaluations, as the report's facts, data and machine first. What several tell, and agree on,
/// is there once; else it is there with the kind that tells it.
std::vector<ReportFact> report_facts(const std::vector<files::MetricFile>& evaluations,
                                     const std::optional<AccuracyDocument>& accuracy);

/// What several evaluations tell under a name; the first that tells it. Empty where none does.
std::string told_about(const std::vector<files::MetricFile>& evaluations, const std::string& name);

}  // namespace toile::evaluate
