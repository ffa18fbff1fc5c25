#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/noise.h"
#include "evaluate/noise_results.h"
#include "evaluate/stability_report.h"

namespace toile::app {
namespace {

int noise(evaluate::NoiseOptions options) {
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::NoiseSummary summary = evaluate::measure_noise(options);
    display.finish();
    std::printf("%s\n%s\n%s", summary.file.c_str(), summary.results.c_str(), evaluate::noise_table(summary).c_str());
    return summary.configured == summary.samples ? all_done : some_samples_failed;
}

void add_noise(CLI::App& parent, Work& chosen) {
    CLI::App* command = parent.add_subcommand("noise", "the simulator's own error: some poses draped again, four ways");
    const auto flags = std::make_shared<Flags>();
    const auto options = std::make_shared<evaluate::NoiseOptions>();
    command
        ->add_option("CONFIG_OR_DATASET", options->source,
                     "a scene in TOML, or a data set (.h5): its poses with its own configuration")
        ->required();
    command->add_option("--set", options->overrides, "overrides one key of the configuration; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command->add_option("--out", options->folder, "folder for noise.h5 and noise.json; made if it is not there")
        ->type_name("DIR")
        ->required();
    command->add_option("--share", options->share, "of the poses, drawn by the scene's seed; at least one")
        ->type_name("S")
        ->capture_default_str();
    add_jobs_flag(*command, *flags);
    command->footer(
        "Drapes each of these poses as configured, with half the step, with a finer tolerance and with the second\n"
        "solver. DIR/noise.h5 holds how far apart each vertex comes to rest; the table sums it up in millimetres. A\n"
        "difference below that cannot be told from the simulator's own error.\n\n"
        "  toile evaluate noise configs/quick.toml --out out/noise --share 0.25\n"
        "  toile evaluate noise out/quick/dataset.h5 --out out/noise");
    command->callback([flags, options, &chosen] {
        options->jobs = flags->jobs;
        chosen = [options] { return noise(*options); };
    });
}

int stability(evaluate::StabilityOptions options, const std::string& solver, const std::string& out) {
    options.solver = solver == "all" ? evaluate::solver_names() : std::vector<std::string>{solver};
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::StabilitySummary summary = evaluate::evaluate_stability(options, out);
    display.finish();
    for (const std::string& path : summary.path) std::printf("%s\n", path.c_str());
    std::fputs(evaluate::stability_table(summary.outcome).c_str(), stdout);
    return summary.passed() ? all_done : some_samples_failed;
}

void add_stability(CLI::App& parent, Work& chosen) {
    CLI::App* command = parent.add_subcommand("stability", "stiff and extreme cases, by solver");
    const auto options = std::make_shared<evaluate::StabilityOptions>();
    const auto solver = std::make_shared<std::string>("implicit"), out = std::make_shared<std::string>();
    command->add_option("--out", *out, "folder for stability.csv, .json and .png; made if it is not there")
        ->type_name("DIR")
        ->required();
    std::vector<std::string> names = evaluate::solver_names();
    names.push_back("all");
    command->add_option("--solver", *solver, "whose, or all")->check(CLI::IsMember(names))->capture_default_str();
    command->add_option("--filter", options->filter, "only cases with this text in their name")->type_name("TEXT");
    command->add_flag("--quick", options->quick, "a few dozen cases without a body: seconds");
    command->add_option("--iterations", options->budget.iterations, "of a try to come to rest; default: the scene's")
        ->check(CLI::Range(1, 1000000));
    command->add_option("--tries", options->budget.tries, "after the first; default: the scene's")
        ->check(CLI::Range(0, 3));
    command->add_flag("--resume", options->resume, "keep the outcomes that DIR has, and run what is missing");
    command->footer(
        "A case passes where the drape comes to rest within the gate, stays finite, and its energy never rises on the\n"
        "way to rest. Exit status 3 if one does not. All of it takes minutes with implicit and hours with the others,\n"
        "which spend their whole budget on what they cannot do. --filter, --solver and an interrupt make parts of it,\n"
        "which --resume puts together.\n\n"
        "  toile evaluate stability --out out/stability --quick\n"
        "  toile evaluate stability --out out/stability --solver all --filter T-shirt\n"
        "  toile evaluate stability --out out/stability --solver xpbd --iterations 300 --tries 0 --resume");
    command->callback([options, solver, out, &chosen] {
        chosen = [options, solver, out] { return stability(*options, *solver, *out); };
    });
}

}  // namespace

void add_evaluate_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("evaluate", "measure the simulator: its noise floor, its stability");
    command->require_subcommand(1);
    command->footer(
        "  toile evaluate noise configs/quick.toml --out out/noise\n"
        "  toile evaluate stability --out out/stability\n\n"
        "toile evaluate NAME --help explains each.");
    add_noise(*command, chosen);
    add_stability(*command, chosen);
    add_evaluate_strain(*command, chosen);
}

}  // namespace toile::app
