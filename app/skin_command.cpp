#include <cstdio>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "generate/single.h"

namespace toile::app {
namespace {

int write_posed_body(const Flags& flags) {
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    generate::write_posed_body(config, flags.pose, flags.out);
    std::printf("%s: the body in pose %d\n", flags.out.c_str(), flags.pose);
    return all_done;
}

}  // namespace

void add_skin_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("skin", "write the posed body as a mesh");
    const auto flags = std::make_shared<Flags>();
    add_config_flag(*command, *flags);
    add_pose_flag(*command, *flags, "pose number, from 0")->required();
    command->add_option("--out", flags->out, "the mesh to write: .obj, .ply or .glb")->type_name("FILE")->required();
    command->footer("  toile skin configs/quick.toml --pose 3 --out body.obj");
    command->callback([flags, &chosen] { chosen = [flags] { return write_posed_body(*flags); }; });
}

}  // namespace toile::app
