#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/validate.h"
#include "generate/validate_recompute.h"

namespace toile::app {
namespace {

struct ValidateFlags {
    std::string file, recompute, dataset;
};

int validate_file(const ValidateFlags& flags, int jobs) {
    const std::string& file = flags.file;
    ProgressDisplay display;
    generate::ValidateOptions options;
    options.jobs = jobs;
    options.dataset = flags.dataset;
    if (!flags.recompute.empty()) options.recompute = generate::recompute_choice(flags.recompute);
    options.step = [&](int done, int total) { display({"checking", done, total, 0}); };
    const generate::Validation validation = generate::validate_file(file, options);
    display.finish();
    print_validation(validation);
    if (validation.defect.empty()) return all_done;
    print_error("the file is not valid: " + validation.defect.front(), file, {});
    return input_at_fault;
}

}  // namespace

void add_validate_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand(
        "validate",
        "check a data set, a problem, a projection or predictions: structure, digests, certificates, residuals");
    const auto flags = std::make_shared<Flags>();
    const auto own = std::make_shared<ValidateFlags>();
    command->add_option("FILE", own->file, "the file")->required();
    command->add_option("--recompute", own->recompute,
                        "make some samples of a data set again and compare: a share such as 1%, or a number");
    command->add_option("--dataset", own->dataset, "the data set that predictions are for: compares ids and vertices");
    add_jobs_flag(*command, *flags);
    command->footer(
        "Lists every defect; the exit status is 0 if there is none, else 2.\n\n  toile validate out/quick/dataset.h5\n"
        "  toile validate projection.h5\n"
        "  toile validate out/quick/dataset.h5 --recompute 1%\n"
        "  toile validate predictions.h5 --dataset out/quick/dataset.h5");
    command->callback([flags, own, &chosen] { chosen = [flags, own] { return validate_file(*own, flags->jobs); }; });
}

}  // namespace toile::app
