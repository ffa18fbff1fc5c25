#pragma once

#include <string>

#include "evaluate/accuracy.h"
#include "evaluate/accuracy_shown.h"
#include "files/dataset_file.h"

namespace toile::evaluate {

/// Writes `summary.results` (metrics, and the member "accuracy" with comparisons, settings, failures and remarks) and
/// `summary.figures_file` (see evaluate/accuracy_file.h): both or neither.
void write_accuracy(const AccuracyOptions& options, const files::DatasetHeader& header, const Shown& shown,
                    const AccuracySummary& summary);

/// The tables on stdout: one for each split, in the units of `quantity_kind`, with the verdict on SqrtMSE. Of the
/// limits and stiffnesses that were tried the strictest and the usual; accuracy.json has all.
std::string accuracy_table(const AccuracySummary& summary);

}  // namespace toile::evaluate
