#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/generate.h"

namespace toile::app {
namespace {

int generate_dataset(const Flags& flags) {
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    ProgressDisplay display;
    const generate::GenerateSummary summary = generate::generate(config, generate_options(flags, display));
    display.finish();
    print_summary(summary);
    return summary.failed.empty() ? all_done : some_samples_failed;
}

}  // namespace

void add_generate_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("generate", "poses, skin, simulate, embed, rasterise: DIR/dataset.h5");
    const auto flags = std::make_shared<Flags>();
    add_generate_flags(*command, *flags);
    add_shard_flag(*command, *flags);
    command->footer(
        "A pose that fails is kept with its reason and the run goes on; the exit status is then 3. A run that is "
        "killed\n"
        "loses the samples in work at most, and --resume goes on with it.\n\n"
        "  toile generate configs/tshirt.toml --out out/tshirt --jobs 2\n"
        "  toile generate configs/quick.toml --out out/four --set poses.count=4\n"
        "  toile generate configs/tshirt.toml --out out/big --shard 3/16 --resume   # one of sixteen, on any machine");
    command->callback([flags, &chosen] { chosen = [flags] { return generate_dataset(*flags); }; });
}

}  // namespace toile::app
