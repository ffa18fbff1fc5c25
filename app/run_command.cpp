#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/progress.h"
#include "app/summary.h"
#include "evaluate/report_page.h"
#include "evaluate/run.h"

namespace toile::app {
namespace {

void print_evaluation(const evaluate::RunSummary& summary) {
    for (const std::string& path : summary.predictions) std::printf("  predictions      %s\n", path.c_str());
    for (const std::string& remark : summary.remark) std::printf("  note             %s\n", remark.c_str());
    if (!summary.report) return;
    std::printf("%s\n", summary.report->page.c_str());
    for (const std::string& line : summary.report->verdict) std::printf("  %s\n", line.c_str());
}

int run_all(const Flags& flags) {
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    ProgressDisplay display;
    evaluate::RunOptions options{generate_options(flags, display), evaluate::report_page()};
    const evaluate::RunSummary summary = evaluate::run(config, options);
    display.finish();
    print_summary(summary.generated);
    print_look(summary.look);
    print_validation(summary.validation);
    print_evaluation(summary);
    if (!summary.validation.defect.empty()) return our_failure;
    return summary.flawless ? all_done : some_samples_failed;
}

}  // namespace

void add_run_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand(
        "run", "everything: generate the data set, validate, predict, project with both priors, evaluate, report");
    const auto flags = std::make_shared<Flags>();
    add_generate_flags(*command, *flags);
    command->footer(
        "Writes DIR/dataset.h5, what one can look at of it, DIR/predictions_*.h5 of the predictors in [predict], the\n"
        "results of what [evaluate] asks for, and DIR/report.html, results.json and results.csv. A pose that fails is\n"
        "kept with its reason; the exit status is then 3, as it is where a projection or a case falls short.\n\n"
        "  toile run configs/quick.toml --out out/quick\n"
        "  toile run configs/quick.toml --out out/tall --set body.height=1.9 --set scene.seed=7");
    command->callback([flags, &chosen] { chosen = [flags] { return run_all(*flags); }; });
}

}  // namespace toile::app
