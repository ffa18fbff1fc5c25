#include <cstdio>
#include <memory>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/runtime.h"

namespace toile::app {
namespace {

int runtime(evaluate::RuntimeOptions options) {
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::RuntimeSummary summary = evaluate::evaluate_runtime(options);
    display.finish();
    std::printf("%s\n%s", summary.file.c_str(), evaluate::runtime_table(summary).c_str());
    return summary.refused() == 0 ? all_done : some_samples_failed;
}

}  // namespace

void add_evaluate_runtime(CLI::App& parent, Work& chosen) {
    CLI::App* command = parent.add_subcommand("runtime", "error against run time: priors, simulators, images and more");
    const auto options = std::make_shared<evaluate::RuntimeOptions>();
    command->add_option("--dataset", options->dataset, "data set (.h5) whose samples are measured")->required();
    command->add_option("--predictions", options->predictions.file,
                        "predictions file that the priors are given; default: the truth with seeded noise");
    command->add_option("--noise", options->predictions.noise, "of the truth with noise, root mean square [m]")
        ->check(CLI::Range(1e-6, 1.0))
        ->capture_default_str();
    command->add_option("--out", options->folder, "folder for runtime.json; made if it is not there")
        ->type_name("DIR")
        ->required();
    command->add_option("--studies", options->studies, "of priors, gradients, solvers, voxel, image, mesh, batch")
        ->type_name("A,B,...")
        ->delimiter(',');
    command->add_flag("--quick", options->quick, "small versions of the studies");
    command->add_option("--samples", options->samples, "that are measured; default 8, with --quick 2")
        ->check(CLI::Range(1, 10000));
    command->add_option("--rounds", options->rounds, "that each is timed, at most; default 5, with --quick 2")
        ->check(CLI::Range(1, 1000));
    command->add_option("--seed", options->predictions.seed, "draws the samples and the noise")->capture_default_str();
    command->footer(
        "Curves of error against seconds a sample, all methods in one run, in turns: what slows the machine down for "
        "a\n"
        "while hits all alike. Errors are distances to reference solutions, which are certified first. Exit status 3\n"
        "where one could not be; the table says which. Ratios of times to one factorisation of the mesh's matrix are\n"
        "what `toile report --gate` compares.\n\n"
        "  toile evaluate runtime --dataset out/quick/dataset.h5 --quick --out out/quick\n"
        "  toile evaluate runtime --dataset D.h5 --predictions P.h5 --studies priors,gradients --out out/runtime");
    command->callback([options, &chosen] {
        options->command = command_line();
        chosen = [options] { return runtime(*options); };
    });
}

}  // namespace toile::app
