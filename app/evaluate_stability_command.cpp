#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/evaluate_commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/stability_report.h"

namespace toile::app {
namespace {

std::vector<std::string> all_solvers() {
    std::vector<std::string> names = evaluate::solver_names();
    names.insert(names.end(), evaluate::prior_names().begin(), evaluate::prior_names().end());
    return names;
}

int stability(evaluate::StabilityOptions options, const std::string& out) {
    if (std::count(options.solver.begin(), options.solver.end(), "all")) options.solver = all_solvers();
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::StabilitySummary summary = evaluate::evaluate_stability(options, out);
    display.finish();
    for (const std::string& path : summary.path) std::printf("%s\n", path.c_str());
    std::fputs(evaluate::stability_table(summary.outcome).c_str(), stdout);
    return summary.passed() ? all_done : some_samples_failed;
}

void add_choice(CLI::App& command, evaluate::StabilityOptions& options) {
    std::vector<std::string> names = all_solvers();
    names.push_back("all");
    options.solver = {"implicit", "inextensibility", "quasistatic"};
    command.add_option("--solver", options.solver, "a solver of the simulator, a prior, or all; may be repeated")
        ->check(CLI::IsMember(names))
        ->allow_extra_args(false)
        ->default_str("implicit inextensibility quasistatic");
    command.add_option("--filter", options.filter, "only cases with this text in their name")->type_name("TEXT");
    command.add_flag("--quick", options.quick, "a few dozen cases without a body, and a few small problems: seconds");
    command.add_option("--iterations", options.budget.iterations, "of a try to come to rest; default: the scene's")
        ->check(CLI::Range(1, 1000000));
    command.add_option("--tries", options.budget.tries, "after the first; default: the scene's")
        ->check(CLI::Range(0, 3));
    command
        .add_option("--problems", options.priors.problems,
                    "random ones for the priors, half of them for each; more hold all of fewer")
        ->type_name("N")
        ->check(CLI::Range(2, 1000000))
        ->capture_default_str();
    command.add_option("--seed", options.priors.draw.seed, "of the problems")->capture_default_str();
}

}  // namespace

void add_evaluate_stability(CLI::App& parent, Work& chosen) {
    CLI::App* command =
        parent.add_subcommand("stability", "stiff and extreme cases of simulator and priors, by solver");
    const auto options = std::make_shared<evaluate::StabilityOptions>();
    const auto out = std::make_shared<std::string>();
    const auto flags = std::make_shared<Flags>();
    command->add_option("--out", *out, "folder for stability.csv, .json and .png; made if it is not there")
        ->type_name("DIR")
        ->required();
    add_choice(*command, *options);
    add_jobs_flag(*command, *flags);
    command->add_flag("--resume", options->resume, "keep the outcomes that DIR has, and run what is missing");
    command->footer(
        "A drape passes where it comes to rest within the gate, stays finite, and its energy never rises on the way "
        "to\n"
        "rest. A problem's sample passes where a prior converges, stays finite, its residual, computed again, is "
        "within\n"
        "the tolerance, and its derivative, where it is tried, is accurate to 1e-9. Exit status 3 if a case does not;\n"
        "what runs it again is kept in DIR/stability_replay, its command in stability.csv.\n\n"
        "The default takes minutes. xpbd and bullet take hours: they spend their whole budget on what they cannot do.\n"
        "--filter, --solver and an interrupt make parts of it, which --resume puts together. Drapes are made one "
        "after\n"
        "the other, whatever --jobs says, so that their times can be compared.\n\n"
        "  toile evaluate stability --out out/stability --quick\n"
        "  toile evaluate stability --out out/stability --solver all --filter T-shirt\n"
        "  toile evaluate stability --out out/stability --solver quasistatic --problems 10000\n"
        "  toile evaluate stability --out out/stability --solver xpbd --iterations 300 --tries 0 --resume");
    command->callback([flags, options, out, &chosen] {
        options->jobs = flags->jobs;
        chosen = [options, out] { return stability(*options, *out); };
    });
}

}  // namespace toile::app
