#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "generate/scene_config.h"

namespace toile::app {
namespace {

int print_config(const Flags& flags) {
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    std::printf("%s\n# what this scene leaves out\n", config.absolute_text.c_str());
    for (const std::string& line : generate::left_out(config)) std::printf("# %s\n", line.c_str());
    return all_done;
}

}  // namespace

void add_config_command(CLI::App& program, Work& chosen) {
    CLI::App* command =
        program.add_subcommand("config", "print the resolved configuration and what the scene leaves out");
    const auto flags = std::make_shared<Flags>();
    add_config_flag(*command, *flags);
    command->footer(
        "Prints every key with its value, unit and bounds; the output is a configuration itself.\n\n"
        "  toile config configs/quick.toml\n"
        "  toile config configs/quick.toml --set poses.count=4 > mine.toml");
    command->callback([flags, &chosen] { chosen = [flags] { return print_config(*flags); }; });
}

}  // namespace toile::app
