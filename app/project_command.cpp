#include <algorithm>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/project.h"

namespace toile::app {
namespace {

constexpr size_t most_listed = 1000;

struct ProjectFlags {
    std::string problem;
    std::vector<std::string> overrides;
    generate::ProjectOptions options;
};

void list(const std::vector<generate::SampleRemark>& remarks, const std::string& problem) {
    const size_t listed = std::min(remarks.size(), most_listed);
    for (size_t i = 0; i < listed; ++i)
        print_error("sample " + std::to_string(remarks[i].sample) + " " + remarks[i].text, problem, {});
    if (listed < remarks.size()) print_error("and " + std::to_string(remarks.size() - listed) + " more", problem, {});
}

int project(generate::Prior prior, ProjectFlags flags) {
    const generate::ProjectConfig config = generate::read_project_config(prior, flags.overrides);
    ProgressDisplay display;
    flags.options.progress = [&display](const generate::Progress& progress) { display(progress); };
    flags.options.interrupted = watch_interrupt();
    const generate::ProjectSummary summary = generate::project(config, flags.options);
    display.finish();
    print_projection(summary, flags.options.out);
    list(summary.failed, flags.options.problem);
    list(summary.doubtful, flags.options.problem);
    return summary.failed.empty() ? all_done : some_samples_failed;
}

void add_prior(CLI::App& project_command, generate::Prior prior, const std::string& name, const std::string& doc,
               const std::string& examples, Work& chosen) {
    CLI::App* command = project_command.add_subcommand(name, doc);
    const auto flags = std::make_shared<ProjectFlags>();
    generate::ProjectOptions& options = flags->options;
    command
        ->add_option("PROBLEM", options.problem, "HDF5: /mesh, /samples/predicted, and /samples/target for gradients")
        ->required();
    command->add_option("--out", options.out, "the projection file to write")->type_name("FILE")->required();
    command->add_flag("--gradient", options.gradient,
                      "also the derivatives of the squared distance to /samples/target");
    command->add_option("--jobs", options.jobs, "threads; the results do not depend on it")
        ->type_name("N")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    command->add_option("--set", flags->overrides, "sets one key; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command->footer("Keys with their defaults:\n\n" + generate::read_project_config(prior, {}).text + "\n" + examples);
    command->callback([flags, prior, &chosen] { chosen = [flags, prior] { return project(prior, *flags); }; });
}

}  // namespace

void add_project_command(CLI::App& program, Work& chosen) {
    CLI::App* command =
        program.add_subcommand("project", "hold predicted cloth to physics: a prior over a problem file");
    command->require_subcommand(1);
    command->footer(
        "A sample that is not finite, or whose accuracy is not reached, is listed and marked in /samples/status; the "
        "exit\n"
        "status is then 3.\n\n"
        "  toile project inextensibility problem.h5 --out projection.h5\n"
        "  toile project quasistatic problem.h5 --out projection.h5 --gradient --set mu=0.5\n\n"
        "toile project PRIOR --help lists the keys of each.");
    add_prior(*command, generate::Prior::inextensibility, "inextensibility",
              "the nearest positions at which no edge is longer than it may be",
              "  toile project inextensibility problem.h5 --out projection.h5 --set stretch_limit=0.02", chosen);
    add_prior(*command, generate::Prior::quasistatic, "quasistatic",
              "the rest of a cloth of springs that is tied to the prediction",
              "  toile project quasistatic problem.h5 --out projection.h5 --set mu=0.5 --jobs 2", chosen);
}

}  // namespace toile::app
