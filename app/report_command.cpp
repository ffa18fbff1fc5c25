#include <cstdio>
#include <memory>
#include <string>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/guard.h"
#include "evaluate/report.h"
#include "evaluate/report_page.h"

namespace toile::app {
namespace {

void print_report(const evaluate::ReportSummary& summary) {
    std::string evaluations;
    for (const std::string& kind : summary.evaluations) evaluations += (evaluations.empty() ? "" : ", ") + kind;
    std::printf("%-14s %s\n", "evaluations", evaluations.c_str());
    std::printf("%-14s %s (%.1f MB", "report", summary.page.c_str(), 1e-6 * static_cast<double>(summary.page_bytes));
    if (summary.shown > 0)
        std::printf(", %zu samples in 3D take %.1f MB of it", summary.shown,
                    1e-6 * static_cast<double>(summary.shown_bytes));
    std::printf(")\n%-14s %s and %s: %zu\n\n", "metrics", summary.results.c_str(), summary.table.c_str(),
                summary.metrics);
    for (const std::string& line : summary.verdict) std::printf("%s\n", line.c_str());
}

int report(const evaluate::ReportOptions& options, bool gate) {
    const evaluate::ReportSummary summary = evaluate::write_report(options);
    print_report(summary);
    if (!gate || !summary.baseline->trips()) return all_done;
    for (const std::string& line : summary.baseline->lines()) std::fprintf(stderr, "%s\n", line.c_str());
    return some_samples_failed;
}

}  // namespace

void add_report_command(CLI::App& program, Work& chosen) {
    auto options = std::make_shared<evaluate::ReportOptions>();
    auto gate = std::make_shared<bool>(false);
    CLI::App* command = program.add_subcommand("report", "gather what evaluations found: a page, tables, a gate");
    command->add_option("folder", options->folder, "where `toile evaluate` left its results (--out)")
        ->type_name("DIR")
        ->required();
    CLI::Option* baseline =
        command->add_option("--baseline", options->baseline, "results.json of an earlier report to compare with")
            ->type_name("FILE");
    command->add_flag("--gate", *gate, "exit status 3 where a metric is worse than the baseline's, or missing")
        ->needs(baseline);
    command->footer(
        "Writes DIR/report.html, one file that fetches nothing; DIR/results.json and DIR/results.csv, every metric\n"
        "with its interval, unit and direction. A metric is worse where it moved the wrong way by more than its\n"
        "tolerance, by more than the noise of both intervals, and by more than the simulator's noise. The gate prints\n"
        "one line for each metric that is worse or missing.\n\n"
        "  toile evaluate accuracy --dataset out/quick/dataset.h5 --out out/quick/report\n"
        "  toile report out/quick/report\n"
        "  toile report out/quick/report --baseline baseline/results.json --gate");
    command->callback([options, gate, &chosen] {
        chosen = [options, gate] {
            options->command = command_line();
            options->page_template = evaluate::report_page();
            return report(*options, *gate);
        };
    });
}

}  // namespace toile::app
