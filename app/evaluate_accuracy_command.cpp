#include <algorithm>
#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "evaluate/accuracy.h"
#include "evaluate/accuracy_results.h"

namespace toile::app {
namespace {

constexpr size_t most_listed = 100;

int accuracy(evaluate::AccuracyOptions options) {
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::AccuracySummary summary = evaluate::evaluate_accuracy(options);
    display.finish();
    std::printf("%s\n%s\n\n%s", summary.results.c_str(), summary.figures_file.c_str(),
                evaluate::accuracy_table(summary).c_str());
    const size_t listed = std::min(summary.failure.size(), most_listed);
    for (size_t k = 0; k < listed; ++k) {
        const evaluate::AccuracyFailure& one = summary.failure[k];
        print_error("sample " + std::to_string(one.id) + " " + one.what, one.predictor + ", " + one.method, {});
    }
    if (listed < summary.failure.size())
        print_error("and " + std::to_string(summary.failure.size() - listed) + " more", summary.results, {});
    return summary.failure.empty() ? all_done : some_samples_failed;
}

}  // namespace

void add_evaluate_accuracy(CLI::App& parent, Work& chosen) {
    CLI::App* command = parent.add_subcommand("accuracy",
                                              "how far predicted cloth is from the truth, before and "
                                              "after each prior");
    const auto flags = std::make_shared<Flags>();
    const auto options = std::make_shared<evaluate::AccuracyOptions>();
    command->add_option("--dataset", options->dataset, "the truth: a data set")->type_name("FILE")->required();
    command
        ->add_option("--predictions", options->predictions,
                     "what to judge; may be repeated; without it the built-in predictors")
        ->type_name("FILE")
        ->allow_extra_args(false);
    command->add_option("--noise", options->noise, "of toile evaluate noise; default: DIR/noise.h5, if there is one")
        ->type_name("FILE");
    const auto splits = std::make_shared<std::vector<std::string>>();
    command->add_option("--split", *splits, "train, validation or test; may be repeated; default: all there are")
        ->check(CLI::IsMember({"train", "validation", "test"}))
        ->allow_extra_args(false);
    command->add_option("--limit", options->limits, "of the inextensibility prior; may be repeated")
        ->type_name("E")
        ->allow_extra_args(false)
        ->capture_default_str();
    command->add_option("--mu", options->mus, "of the quasistatic prior; may be repeated")
        ->type_name("M")
        ->allow_extra_args(false)
        ->capture_default_str();
    const auto learn = std::make_shared<std::string>();
    command
        ->add_option(
            "--learn-mu", *learn,
            "by gradient on the train split: none, one for all vertices (global), or one for each too (vertex); "
            "default: vertex, where the train split is predicted")
        ->check(CLI::IsMember({"none", "global", "vertex"}));
    command
        ->add_option("--overstretched", options->overstretched_limit,
                     "an edge beyond (1 + E) times its rest length counts as overstretched")
        ->type_name("E")
        ->capture_default_str();
    command->add_option("--samples", options->samples, "of each split at most, drawn by the data set's seed; 0: all")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--shown", options->shown, "samples to keep for the report's 3D view")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--out", options->folder, "folder for accuracy.json and accuracy.h5; made if it is not there")
        ->type_name("DIR")
        ->required();
    add_jobs_flag(*command, *flags);
    command->footer(
        "Judges every accepted sample: the prediction, and what each prior makes of it. One table for each split; "
        "with\n"
        "95 % intervals, distributions and verdicts in DIR/accuracy.json, and every sample's values in\n"
        "DIR/accuracy.h5. Exit status 3 where a prior did not reach its accuracy on a sample; such samples are listed\n"
        "and count all the same.\n\n"
        "  toile evaluate accuracy --dataset out/quick/dataset.h5 --predictions predictions.h5 --out out/evaluation\n"
        "  toile evaluate accuracy --dataset out/quick/dataset.h5 --split test --mu 0.1 --limit 0 --out "
        "out/evaluation");
    command->callback([flags, options, splits, learn, &chosen] {
        options->jobs = flags->jobs;
        for (const std::string& one : *splits)
            options->splits.push_back(one == "train" ? 0 : one == "validation" ? 1 : 2);
        if (!learn->empty())
            options->learn_mu = *learn == "none"     ? evaluate::LearnMu::none
                                : *learn == "global" ? evaluate::LearnMu::global
                                                     : evaluate::LearnMu::vertex;
        chosen = [options] { return accuracy(*options); };
    });
}

}  // namespace toile::app
