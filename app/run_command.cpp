#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/run.h"

namespace toile::app {
namespace {

int run_all(const Flags& flags) {
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    ProgressDisplay display;
    const generate::RunSummary summary = generate::run(config, generate_options(flags, display));
    display.finish();
    print_summary(summary.generated);
    print_look(summary.look);
    print_validation(summary.validation);
    if (!summary.validation.defect.empty()) return our_failure;
    return summary.generated.failed.empty() ? all_done : some_samples_failed;
}

}  // namespace

void add_run_command(CLI::App& program, Work& chosen) {
    CLI::App* command =
        program.add_subcommand("run", "everything: generate the data set, write what to look at, validate");
    const auto flags = std::make_shared<Flags>();
    add_generate_flags(*command, *flags);
    command->footer(
        "Writes DIR/dataset.h5, DIR/config.toml, a glTF of body and cloth for a few samples (output.look) and\n"
        "DIR/displacements.png. A pose that fails is kept with its reason; the exit status is then 3.\n\n"
        "  toile run configs/quick.toml --out out/quick\n"
        "  toile run configs/quick.toml --out out/tall --set body.height=1.9 --set scene.seed=7");
    command->callback([flags, &chosen] { chosen = [flags] { return run_all(*flags); }; });
}

}  // namespace toile::app
