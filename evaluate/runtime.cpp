#include "evaluate/runtime.h"

#include <algorithm>

#include "cloth/error.h"
#include "evaluate/batch_study.h"
#include "evaluate/image_study.h"
#include "evaluate/machine_facts.h"
#include "evaluate/mesh_study.h"
#include "evaluate/prior_study.h"
#include "evaluate/runtime_results.h"
#include "evaluate/solver_study.h"
#include "evaluate/voxel_study.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"

namespace toile::evaluate {
namespace {

/// Of things that take seconds rather than milliseconds each.
constexpr int slow_rounds = 2;
/// A garment of some 370 vertices, of which quick drapes are made [m].
constexpr const char* quick_garment = "garment.edge_length=0.05";

RepeatOptions repeat_of(const RuntimeOptions& options, const std::string& stage) {
    RepeatOptions repeat;
    repeat.rounds = options.rounds > 0 ? options.rounds : options.quick ? 2 : 5;
    repeat.least = options.quick ? 1 : std::min(2, repeat.rounds);
    repeat.budget = options.quick ? 0.5 : 20.0;
    repeat.interrupted = options.interrupted;
    if (options.progress)
        repeat.progress = [&options, stage](const generate::Progress& progress) {
            options.progress({stage, progress.done, progress.total, 0});
        };
    return repeat;
}

PriorSweep prior_sweep(bool quick) {
    if (!quick) return {};
    return {{1e-2, 1e-4, 1e-6, 1e-8}, {1, 8, 64, 512}};
}

Study run_solvers(const RuntimeOptions& options, const RuntimeSamples& samples, RepeatOptions repeat) {
    SolverSweep sweep;
    repeat.rounds = repeat.least = std::min(repeat.rounds, options.quick ? 1 : slow_rounds);
    if (options.quick) {
        sweep.quick = true;
        sweep.poses = 1;
        sweep.patience = 5;
        if (why_no_sizes(samples, options.dataset).empty()) sweep.changes = {quick_garment};
    }
    return study_solvers(samples, options.dataset, sweep, repeat, options.clock);
}

Study run_meshes(const RuntimeOptions& options, const RuntimeSamples& samples, RepeatOptions repeat) {
    MeshSweep sweep;
    if (options.quick) {
        sweep.edge_length = {0.05, 0.04, 0.03};
        sweep.poses = 1;
    }
    repeat.rounds = std::min(repeat.rounds, 3);
    return study_meshes(samples, options.dataset, sweep, repeat, options.clock);
}

Study run_batches(const RuntimeOptions& options, const RuntimeSamples& samples, const RepeatOptions& repeat) {
    BatchSweep sweep;
    if (options.quick) sweep = {{1, 4, 16}, {1, 2}};
    return study_batches(samples, sweep, repeat, options.clock, options.wall);
}

Study run_study(const std::string& name, const RuntimeOptions& options, const RuntimeSamples& samples) {
    const RepeatOptions repeat = repeat_of(options, name);
    if (options.progress) options.progress({name, 0, 0, 0});
    if (name == "priors") return study_priors(samples, prior_sweep(options.quick), repeat, options.clock);
    if (name == "gradients") return study_gradients(samples, prior_sweep(options.quick), repeat, options.clock);
    if (name == "solvers") return run_solvers(options, samples, repeat);
    if (name == "voxel") {
        VoxelSweep sweep;
        if (options.quick) sweep.voxel = {0.020, 0.010, 0.006};
        return study_voxels(samples, options.dataset, sweep, repeat, options.clock);
    }
    if (name == "image") {
        ImageSweep sweep;
        if (options.quick) sweep.size = {32, 64, 128};
        return study_images(samples, sweep, repeat, options.clock);
    }
    if (name == "mesh") return run_meshes(options, samples, repeat);
    return run_batches(options, samples, repeat);
}

/// The studies asked for, in their own order.
std::vector<std::string> chosen_studies(const std::vector<std::string>& asked) {
    const std::vector<std::string>& all = study_names();
    for (const std::string& one : asked)
        if (std::find(all.begin(), all.end(), one) == all.end()) {
            std::string known;
            for (const std::string& name : all) known += (known.empty() ? "" : ", ") + name;
            throw Error("there is no study \"" + one + "\"", "--studies", "there are " + known);
        }
    std::vector<std::string> chosen;
    for (const std::string& name : all)
        if (asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end()) chosen.push_back(name);
    return chosen;
}

}  // namespace

const std::vector<std::string>& study_names() {
    static const std::vector<std::string> name{"priors", "gradients", "solvers", "voxel", "image", "mesh", "batch"};
    return name;
}

int RuntimeSummary::refused() const {
    int count = 0;
    for (const Study& one : study) count += one.refused;
    return count;
}

RuntimeSummary evaluate_runtime(const RuntimeOptions& options) {
    const double start = options.wall();
    const std::vector<std::string> chosen = chosen_studies(options.studies);
    const std::vector<MachineFact> machine = machine_facts();
    const int count = options.samples > 0 ? options.samples : options.quick ? 2 : 8;
    const RuntimeSamples samples = read_runtime_samples(options.dataset, count, options.predictions);
    const generate::OutputFolder folder(options.folder, generate::OutputFolder::For::results);
    RuntimeSummary summary;
    summary.file = folder.file("runtime.json");
    for (const std::string& name : chosen) {
        if (options.interrupted && *options.interrupted)
            throw generate::Interrupted("interrupted: no study was written");
        summary.study.push_back(run_study(name, options, samples));
    }
    summary.seconds = options.wall() - start;
    write_runtime_results(summary, options, samples, machine);
    return summary;
}

}  // namespace toile::evaluate
