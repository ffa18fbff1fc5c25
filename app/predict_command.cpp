#include <cmath>
#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/predict.h"

namespace toile::app {
namespace {

int predict_dataset(evaluate::PredictOptions options) {
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::PredictSummary summary = evaluate::predict(options);
    display.finish();
    std::printf("%s\n%s", options.out.c_str(), evaluate::predict_table(summary).c_str());
    return all_done;
}

void add_fit_flags(CLI::App& command, evaluate::PredictorOptions& options) {
    command.add_option("--predictor", options.predictor, "which")
        ->check(CLI::IsMember(evaluate::predictor_names()))
        ->capture_default_str();
    command
        .add_option("--components", options.components,
                    "ridge: principal components of displacement; default: those that hold 99.9 % of the train split's "
                    "variance, at most 128")
        ->type_name("N")
        ->check(CLI::Range(1, 10000));
    command
        .add_option("--ridge", options.ridge,
                    "ridge: strength, in samples of mean size; default: chosen by cross-validation on the train split")
        ->type_name("L")
        ->check(CLI::Range(0.0, 1e12));
    command.add_option("--seed", options.seed, "draws the samples that components are taken from, of more than 1024")
        ->type_name("S")
        ->capture_default_str();
    command.add_option("--jobs", options.jobs, "threads; the results do not depend on it")
        ->type_name("N")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
}

}  // namespace

void add_predict_command(CLI::App& program, Work& chosen) {
    CLI::App* command =
        program.add_subcommand("predict", "a built-in predictor, fitted on the train split of a data set");
    const auto options = std::make_shared<evaluate::PredictOptions>();
    command->add_option("DATASET", options->dataset, "a data set of cloth on a body (.h5)")->required();
    command->add_option("--out", options->out, "the predictions file to write")->type_name("FILE")->required();
    add_fit_flags(*command, options->predictor);
    command->footer(
        "  ridge    principal components of displacement, each by ridge regression on the joints' rotation matrices\n"
        "  mean     the mean displacement of the train split, whatever the pose\n"
        "  nearest  the displacement of the train sample whose pose is nearest, over all joints\n"
        "  image    the displacement read back from the sample's own image: what the image alone costs\n\n"
        "All accepted samples are predicted, those of the train split too: cloth is the stored embedded position plus\n"
        "the predicted displacement in the stored frame. The file has /samples/id and /samples/predicted; so has that "
        "of\n"
        "any network, and every command takes it.\n\n"
        "  toile predict out/quick/dataset.h5 --out out/quick/ridge.h5\n"
        "  toile predict out/quick/dataset.h5 --out out/quick/nearest.h5 --predictor nearest\n"
        "  toile validate out/quick/ridge.h5 --dataset out/quick/dataset.h5");
    command->callback([options, &chosen] { chosen = [options] { return predict_dataset(*options); }; });
}

}  // namespace toile::app
