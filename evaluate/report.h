#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evaluate/baseline_section.h"

namespace toile::evaluate {

struct ReportOptions {
    std::string folder;  ///< where the evaluations left `<kind>.json`; report.html, results.json and results.csv in it
                         ///< are replaced
    std::string baseline;            ///< results.json of an earlier run to compare with; may be empty
    std::string command;             ///< said in the report
    std::string_view page_template;  ///< see filled_page.h
};

struct ReportSummary {
    std::string page, results, table;  ///< paths of report.html, results.json, results.csv
    size_t page_bytes = 0;
    size_t shown = 0, shown_bytes = 0;     ///< samples in the 3D view, and what they take of the page
    std::vector<std::string> evaluations;  ///< kinds that were found
    size_t metrics = 0;
    std::vector<std::string> verdict;
    std::optional<BaselineComparison> baseline;
};

/// Gathers what the evaluations left in a folder: a page to look at, which is one file and fetches nothing, and every
/// metric as JSON and as comma-separated values. All three are written, or none. Throws Error where the folder is
/// missing or holds no results, where results or baseline cannot be read or are of another version.
ReportSummary write_report(const ReportOptions& options);

}  // namespace toile::evaluate
