// A report as `toile report` writes it, for test_report.mjs: report_for_browser OUT.html
#include <exception>
#include <filesystem>
#include <iostream>

#include "evaluate/report.h"
#include "evaluate/report_page.h"
#include "tests/evaluate/evaluated_folder.h"

int main(int count, char** arguments) {
    if (count != 2) {
        std::cerr << "report_for_browser OUT.html\n";
        return 2;
    }
    try {
        toile::evaluate::EvaluatedFolder folder;
        folder.write();
        folder.write_arrays();
        const toile::evaluate::ReportSummary summary =
            toile::evaluate::write_report({folder.path(), "", "toile report DIR", toile::evaluate::report_page()});
        std::filesystem::copy_file(summary.page, arguments[1], std::filesystem::copy_options::overwrite_existing);
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
