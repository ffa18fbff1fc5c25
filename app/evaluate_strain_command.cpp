#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/command_line.h"
#include "app/evaluate_commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "cloth/error.h"
#include "evaluate/strain.h"

namespace toile::app {
namespace {

/// What the flags say before it is checked.
struct StrainFlags {
    evaluate::StrainOptions options;
    std::string deformed, neighbourhood = "ring:1", store;
    bool rates = false;
};

int strain(StrainFlags flags, bool timed, int jobs) {
    evaluate::StrainOptions& options = flags.options;
    options.neighbourhood = evaluate::neighbourhood_rule(flags.neighbourhood);
    if (timed && !(options.time_step > 0))
        throw Error("--time-step must be a positive number of seconds", "command line");
    if (flags.rates && !timed && options.dataset.empty())
        throw Error("--rates needs --time-step, the time between frames", "command line", "add --time-step SECONDS");
    if (flags.rates && !options.dataset.empty())
        throw Error("a data set has no rates: its samples have no time between them", options.dataset,
                    "leave --rates out");
    if (!flags.deformed.empty() && options.rest.empty()) throw Error("--deformed needs --rest", "command line");
    if (!flags.deformed.empty()) options.sequence = {flags.deformed};
    const std::string store = flags.store.empty() ? (options.dataset.empty() ? "all" : "stretches") : flags.store;
    options.stretches_only = store == "stretches";
    options.jobs = jobs;
    options.command = command_line();
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const evaluate::StrainSummary summary = evaluate::evaluate_strain(options);
    display.finish();
    for (const std::string& path : summary.path) std::printf("%s\n", path.c_str());
    std::fputs(evaluate::strain_table(summary).c_str(), stdout);
    return all_done;
}

void add_input_flags(CLI::App& command, StrainFlags& flags) {
    evaluate::StrainOptions& options = flags.options;
    command
        .add_option("--rest", options.rest,
                    "the mesh at rest: .obj, .ply, or a file of ours (.h5), whose pattern it is; else the first frame")
        ->type_name("MESH");
    CLI::Option* deformed = command.add_option("--deformed", flags.deformed, "one deformed mesh")->type_name("MESH");
    CLI::Option* sequence = command
                                .add_option("--sequence", options.sequence,
                                            "deformed meshes: files, a folder, or a pattern in quotes, 'frames/*.ply'")
                                ->type_name("FRAMES");
    CLI::Option* dataset =
        command.add_option("--dataset", options.dataset, "its accepted samples, from its pattern")->type_name("FILE");
    deformed->excludes(sequence)->excludes(dataset);
    sequence->excludes(dataset);
    command.add_option("--split", options.split, "of the data set; may be repeated; default: all")
        ->check(CLI::IsMember({"train", "validation", "test"}))
        ->allow_extra_args(false)
        ->needs(dataset);
}

void add_measure_flags(CLI::App& command, StrainFlags& flags) {
    evaluate::StrainOptions& options = flags.options;
    command
        .add_option("--neighbourhood", flags.neighbourhood,
                    "of a vertex: ring:K, radius:METRES or nearest:N, at rest and joined by edges")
        ->type_name("RULE")
        ->capture_default_str();
    command
        .add_option("--normal-weight", options.normal_weight,
                    "of the surface normal among a vertex' correspondences; 0 leaves it out")
        ->type_name("W")
        ->capture_default_str();
    command
        .add_option("--store", flags.store,
                    "what strain.h5 holds: all, or stretches (the default of a data set) and rates alone")
        ->check(CLI::IsMember({"all", "stretches"}));
    command.add_option("--look", options.look, "meshes coloured by stretch, of frames evenly chosen")
        ->type_name("N")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    command.add_option("--look-format", options.look_format, "of these meshes: ply or glb")
        ->check(CLI::IsMember({"ply", "glb"}))
        ->capture_default_str();
}

}  // namespace

void add_evaluate_strain(CLI::App& parent, Work& chosen) {
    CLI::App* command =
        parent.add_subcommand("strain", "stretches, directions and rates of a mesh, a sequence, a data set");
    const auto flags = std::make_shared<StrainFlags>();
    const auto shared = std::make_shared<Flags>();
    add_input_flags(*command, *flags);
    CLI::Option* time_step =
        command->add_option("--time-step", flags->options.time_step, "between frames [s]: adds strain rates and spins")
            ->type_name("SECONDS");
    command->add_flag("--rates", flags->rates, "fail where rates cannot be had");
    add_measure_flags(*command, *flags);
    command->add_option("--out", flags->options.folder, "folder for strain.h5 and strain.json; made if it is not there")
        ->type_name("DIR")
        ->required();
    add_jobs_flag(*command, *shared);
    command->footer(
        "Each triangle: the deformation gradient F from its edges, F = R U, principal stretches and directions. Each\n"
        "vertex: F and Kabsch's rotation fitted to its neighbourhood and normal. With a time step: L = dF/dt F^-1, "
        "its\n"
        "strain rates and spin, and the error that the time step leaves in them. What has no value is named and "
        "counted.\n"
        "Vertices must come in one order in all files.\n\n"
        "  toile evaluate strain --rest rest.obj --deformed a.obj --out out/strain --look 1\n"
        "  toile evaluate strain --rest rest.obj --sequence 'frames/*.ply' --time-step 0.0417 --neighbourhood ring:2 "
        "--out "
        "out/strain\n"
        "  toile evaluate strain --dataset out/quick/dataset.h5 --split test --out out/strain");
    command->callback([flags, shared, time_step, &chosen] {
        const bool timed = time_step->count() > 0;
        chosen = [flags, shared, timed] { return strain(*flags, timed, shared->jobs); };
    });
}

}  // namespace toile::app
