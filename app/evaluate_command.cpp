#include <cstdio>

#include "app/commands.h"
#include "app/evaluate_commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/noise.h"
#include "evaluate/noise_results.h"

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

}  // namespace

void add_evaluate_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("evaluate", "measure the simulator and the priors");
    command->require_subcommand(1);
    command->footer(
        "  toile evaluate noise configs/quick.toml --out out/noise\n"
        "  toile evaluate stability --out out/stability\n"
        "  toile evaluate strain --rest rest.obj --deformed a.obj --out out/strain\n\n"
        "toile evaluate NAME --help explains each.");
    add_noise(*command, chosen);
    add_evaluate_stability(*command, chosen);
    add_evaluate_accuracy(*command, chosen);
    add_evaluate_runtime(*command, chosen);
    add_evaluate_strain(*command, chosen);
}

}  // namespace toile::app
