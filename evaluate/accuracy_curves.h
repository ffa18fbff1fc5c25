#pragma once

#include <string>
#include <vector>

#include "evaluate/accuracy_document.h"
#include "evaluate/report_document.h"

namespace toile::evaluate {

/// SqrtMSE and the energies' errors against μ (paper, Figures 7 and 9) and against the limit, a line for each
/// predictor, with the predictions themselves as level lines. None of what has fewer than two points.
std::vector<ReportCurves> accuracy_curves(const AccuracyDocument& document, const std::string& split);

/// How the samples' errors are spread, for each predictor: as predicted, and after the best of each prior's methods.
/// `arrays`: the accuracy.h5 of the same evaluation.
std::vector<ReportHistogram> accuracy_histograms(const AccuracyDocument& document, const std::string& split,
                                                 const std::string& arrays);

/// Edges `[bins + 1]` over the values' range on a logarithmic scale, and how many of each series fall between them.
ReportHistogram histogram_of(std::string id, std::string title,
                             const std::vector<std::pair<std::string, std::vector<double>>>& series, int bins);

}  // namespace toile::evaluate
