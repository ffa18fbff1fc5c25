#include <map>

#include "app/commands.h"
#include "app/flags.h"
#include "app/guard.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/summary.h"
#include "generate/export.h"

namespace toile::app {
namespace {

using generate::ExportFormat;

const std::map<std::string, ExportFormat> formats = {{"npz", ExportFormat::npz},   {"obj", ExportFormat::obj},
                                                     {"ply", ExportFormat::ply},   {"pc2", ExportFormat::pc2},
                                                     {"gltf", ExportFormat::gltf}, {"xdmf", ExportFormat::xdmf}};
const std::map<std::string, int> splits = {{"train", 0}, {"validation", 1}, {"test", 2}};

const char* const explanation =
    "Accepted samples only, in the order of the data set. Metres, y up; samples are drapes at rest, with no time\n"
    "between them.\n\n"
    "  npz    --out FILE.npz: vertices_seq (N,V,3), faces (F,3), uv (P,2) the pattern in metres, uv_faces (F,3),\n"
    "         body_vertices_seq, body_faces, poses (N,3J) axis-angle from the bind pose, joint_names, joint_parents,\n"
    "         trans (zero: the root stays), mocap_framerate, id, split (0 train, 1 validation, 2 test), status, "
    "reasons\n"
    "  obj    --out DIR: cloth_000123.obj and body_000123.obj by pose number, vt the pattern in metres\n"
    "  ply    --out DIR: the same in binary .ply, the pattern as texcoord of the faces\n"
    "  pc2    --out DIR: cloth.pc2 and body.pc2 point caches, with cloth.obj and body.obj for their topology\n"
    "  gltf   --out FILE.glb: cloth as morph targets (24 bytes a vertex and sample), body as a skin; no blend between\n"
    "         samples; up to 2 GB, so choose samples with --pose or --at-most\n"
    "  xdmf   --out FILE.xdmf, which refers to the data set, with FILE.body.h5: open it with ParaView's \"XDMF "
    "Reader\"\n\n"
    "A file is replaced if it is there, a folder must not be.\n\n"
    "  toile export out/quick/dataset.h5 --format npz --out quick.npz --split train\n"
    "  toile export out/quick/dataset.h5 --format gltf --out quick.glb --pose 0-9 --rate 2";

int export_dataset(generate::ExportOptions options, const std::string& poses) {
    if (!poses.empty()) options.pose = generate::parse_pose_ranges(poses);
    ProgressDisplay display;
    options.progress = [&display](const generate::Progress& progress) { display(progress); };
    options.interrupted = watch_interrupt();
    const generate::ExportSummary summary = generate::export_dataset(options);
    display.finish();
    print_export(summary);
    return summary.not_finite == 0 ? all_done : some_samples_failed;
}

struct ExportFlags {
    generate::ExportOptions options;
    std::string poses, status = "accepted";
    int split = -1;
    bool without_body = false;
};

void add_selection_flags(CLI::App& command, ExportFlags& flags) {
    command.add_option("--pose", flags.poses, "only these pose numbers, for example 7 or 3,10-20")->type_name("K,K-L");
    command.add_option("--split", flags.split, "only one split: train, validation or test")
        ->transform(CLI::CheckedTransformer(splits))
        ->option_text("S");
    command.add_option("--status", flags.status, "accepted, or all: those that failed too")
        ->check(CLI::IsMember({"accepted", "all"}))
        ->option_text("S=accepted");
    command.add_option("--at-most", flags.options.at_most, "of those, so many, evenly spread")
        ->type_name("N")
        ->check(CLI::Range(int64_t{1}, int64_t{1} << 40));
}

}  // namespace

void add_export_command(CLI::App& program, Work& chosen) {
    CLI::App* command = program.add_subcommand("export", "write a data set for other programs");
    const auto flags = std::make_shared<ExportFlags>();
    generate::ExportOptions& options = flags->options;
    command->add_option("DATASET", options.dataset, "the data set")->required();
    command->add_option("--format", options.format, "npz, obj, ply, pc2, gltf or xdmf")
        ->transform(CLI::CheckedTransformer(formats))
        ->option_text("F REQUIRED")
        ->required();
    command->add_option("--out", options.out, "the file or folder to write")->type_name("PATH")->required();
    add_selection_flags(*command, *flags);
    command->add_flag("--no-body", flags->without_body, "leave the body out");
    command->add_option("--rate", options.rate, "poses a second (npz, gltf)")->type_name("R")->capture_default_str();
    command->footer(explanation);
    command->callback([flags, &chosen] {
        chosen = [flags] {
            flags->options.body = !flags->without_body;
            flags->options.failed = flags->status == "all";
            if (flags->split >= 0) flags->options.split = flags->split;
            return export_dataset(flags->options, flags->poses);
        };
    });
}

}  // namespace toile::app
