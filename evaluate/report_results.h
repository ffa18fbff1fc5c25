#pragma once

#include <string>
#include <vector>

#include "files/metric_comparison.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// All metrics of several evaluations as one file of the kind "results", in their order. What is told about each is
/// called "<kind>.<name>" there. Throws Error for two metrics of the same name.
files::MetricFile gathered_results(const std::vector<files::MetricFile>& evaluations);

/// The metrics as comma-separated values (RFC 4180, lines end with \n): a head of
/// metric,value,low,high,unit,direction,tolerance,samples,median,p95,p99,largest,floor and a row each. Texts are quoted
/// where they must be; what is no number is empty.
std::string results_csv(const files::MetricFile& results);

}  // namespace toile::evaluate
