#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/summary.h"
#include "cloth/error.h"
#include "evaluate/stability_replay.h"
#include "generate/replay.h"
#include "generate/single.h"

namespace toile::app {
namespace {

int exit_status(const simulate::DrapeResult& result) {
    return result.status == simulate::DrapeStatus::accepted ? all_done : some_samples_failed;
}

int replay_case(const Flags& flags) {
    const evaluate::ReplayedCase again = evaluate::replay_case(flags.replay, flags.overrides, flags.out);
    print_replay(again.replayed, flags.out);
    return again.outcome.passed() ? all_done : some_samples_failed;
}

int replay_one(const Flags& flags) {
    if (evaluate::is_case_replay(flags.replay)) return replay_case(flags);
    const generate::Replayed replayed = generate::replay_once(flags.replay, flags.overrides, flags.out);
    print_replay(replayed, flags.out);
    return exit_status(replayed.drape);
}

int simulate_one(const Flags& flags) {
    if (!flags.replay.empty()) return replay_one(flags);
    if (flags.config.empty()) throw Error("neither CONFIG nor --replay is given", "command line");
    const generate::SceneConfig config = generate::read_scene(flags.config, flags.overrides);
    const simulate::DrapeResult result = generate::simulate_once(config, flags.pose, flags.out);
    print_drape(result, flags.out);
    return exit_status(result);
}

}  // namespace

void add_simulate_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("simulate", "drape the cloth once and write it as a mesh");
    const auto flags = std::make_shared<Flags>();
    CLI::Option* config = add_config_flag(*command, *flags)->required(false);
    CLI::Option* pose = add_pose_flag(*command, *flags, "pose number, from 0; without it the neutral pose");
    command
        ->add_option("--replay", flags->replay,
                     "runs a pose, or a case of the stability suite, that failed again, in place of CONFIG")
        ->type_name("FILE")
        ->excludes(config)
        ->excludes(pose);
    command->add_option("--out", flags->out, "the mesh to write: .obj, .ply or .glb")->type_name("FILE")->required();
    command->footer(
        "Also runs scenes without a body. Prints the certificate; exit status 3 if the drape is not accepted.\n\n"
        "  toile simulate configs/patch.toml --out patch.glb\n"
        "  toile simulate configs/quick.toml --pose 3 --out shirt.obj\n"
        "  toile simulate --replay out/quick/replay/pose_000003.h5 --out shirt.obj");
    command->callback([flags, &chosen] { chosen = [flags] { return simulate_one(*flags); }; });
}

}  // namespace toile::app
