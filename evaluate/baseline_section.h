#pragma once

#include <string>
#include <vector>

#include "evaluate/report_document.h"
#include "files/metric_comparison.h"

namespace toile::evaluate {

/// Results next to those of an earlier run.
struct BaselineComparison {
    std::string path;
    std::string program_version;               ///< of the baseline
    std::vector<std::string> differences;      ///< what was not the same: "accuracy.config_hash: 12ab, was 34cd"
    std::vector<files::MetricChange> changes;  ///< regressions first

    int count(files::MetricChange::Outcome outcome) const;
    bool trips() const;
    std::vector<std::string> lines() const;  ///< one for each metric that trips
};

/// Compares with a results.json. Throws Error, naming file and key, for one that is missing, of another version, or no
/// such file.
BaselineComparison compare_with_baseline(const std::string& path, const files::MetricFile& results);

/// "Against the baseline": a table of all metrics that it judges, regressions first.
ReportSection baseline_section(const BaselineComparison& comparison);

/// One sentence of it, for the verdict.
std::string baseline_verdict(const BaselineComparison& comparison);

}  // namespace toile::evaluate
