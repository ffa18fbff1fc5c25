#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/accuracy_document.h"
#include "evaluate/baseline_section.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// The report in five lines, made of the evaluations' numbers: the error on test before and after each prior, and
/// whether the difference is more than noise; the best μ; what it costs in time; what broke; the baseline. Each says so
/// where a number is missing, and which command makes it.
std::vector<std::string> report_verdict(const std::optional<AccuracyDocument>& accuracy,
                                        const std::vector<files::MetricFile>& evaluations,
                                        const std::optional<BaselineComparison>& baseline);

}  // namespace toile::evaluate
