#include <gtest/gtest.h>

#include <filesystem>

#include "evaluate/report.h"
#include "evaluate/report_page.h"
#include "tests/evaluate/evaluated_folder.h"

namespace toile::evaluate {
namespace {

/// Leaves a report as `toile report` writes it where test_report.mjs opens it in a browser.
TEST(ReportForBrowser, is_written_whole) {
    EvaluatedFolder folder;
    folder.write();
    folder.write_arrays();
    const ReportSummary summary = write_report({folder.path(), "", "toile report DIR", report_page()});
    EXPECT_GT(summary.page_bytes, report_page().size());
    std::filesystem::copy_file(summary.page, TOILE_WEB_OUT "/real_report.html",
                               std::filesystem::copy_options::overwrite_existing);
}

}  // namespace
}  // namespace toile::evaluate
