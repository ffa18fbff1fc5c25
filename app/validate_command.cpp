#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/validate.h"

namespace toile::app {
namespace {

int validate_file(const std::string& file, int jobs) {
    ProgressDisplay display;
    generate::ValidateOptions options;
    options.jobs = jobs;
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
        "validate", "check a data set, a problem or a projection: structure, digests, certificates, residuals");
    const auto flags = std::make_shared<Flags>();
    command->add_option("FILE", flags->out, "the file")->required();
    add_jobs_flag(*command, *flags);
    command->footer(
        "Lists every defect; the exit status is 0 if there is none, else 2.\n\n  toile validate out/quick/dataset.h5\n"
        "  toile validate projection.h5");
    command->callback([flags, &chosen] { chosen = [flags] { return validate_file(flags->out, flags->jobs); }; });
}

}  // namespace toile::app
