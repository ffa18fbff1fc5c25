#include "generate/generate.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/file_lock.h"
#include "files/new_file.h"
#include "generate/dataset_card.h"
#include "generate/export.h"
#include "generate/merge.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"
#include "generate/shard_work.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

void check_complete(const SceneConfig& config) {
    if (!config.body)
        throw Error("this scene has no [body]: there are no poses to make samples of", config.file,
                    "drape it with toile simulate");
    if (!config.poses) throw Error("this scene has no [poses]: there is nothing to make samples of", config.file);
}

void check_shard(const ShardNumber& shard, const std::vector<ShardNumber>& there, const GenerateOptions& options) {
    for (const ShardNumber& other : there) {
        if (other.count != shard.count)
            throw Error("this folder is divided into " + std::to_string(other.count) + " shards, not into " +
                            std::to_string(shard.count),
                        options.folder, "shards are counted as they were begun; or choose another --out");
        if (other.index == shard.index && !options.resume)
            throw Error("this shard was begun already", (fs::path(options.folder) / shard_folder_name(other)).string(),
                        "--resume goes on with it");
    }
}

/// Which shards this run is to fill, by what is in the folder.
std::vector<ShardNumber> shards_to_fill(const GenerateOptions& options) {
    const std::vector<ShardNumber> there = shards_in(options.folder);
    const bool finished = fs::exists(fs::path(options.folder) / "dataset.h5");
    if (finished && !options.resume)
        throw Error("this folder holds a data set already", options.folder,
                    "choose another --out; or --resume makes again what is missing or damaged");
    if (options.shard) {
        check_shard(*options.shard, there, options);
        if (finished && there.empty())
            throw Error("this folder holds a whole data set, not shards", options.folder, "choose another --out");
        return {*options.shard};
    }
    if (there.empty()) return {{0, 1}};
    if (!options.resume) throw Error("this folder holds unfinished work", options.folder, "--resume goes on with it");
    if (there.front().count != there.back().count)
        throw Error("this folder holds shards of " + std::to_string(there.front().count) + " and of " +
                        std::to_string(there.back().count),
                    options.folder, "remove those that were begun by mistake");
    std::vector<ShardNumber> all;
    for (int index = 0; index < there.front().count; ++index) all.push_back({index, there.front().count});
    return all;
}

/// One run: what its stages share.
struct Run {
    const SceneConfig& config;
    const GenerateOptions& options;
    GenerateSummary& summary;
    SampleTally tally = {};

    std::string file(const std::string& name) const { return (fs::path(options.folder) / name).string(); }
    PlanOptions plan_options() const {
        return {options.jobs, options.memory_limit, options.progress, options.interrupted};
    }
};

/// A finished data set has no plan any more; another configuration's must not be planned beside it. One that cannot be
/// read is made again.
void check_finished(const Run& run) {
    const std::string& dataset = run.summary.dataset;
    if (run.options.shard || !fs::exists(dataset)) return;
    std::string hash;
    try {
        hash = files::DatasetReader(dataset).header().config_hash;
    } catch (const Error&) {
        return;
    }
    if (hash != run.config.hash)
        throw Error("this folder's data are of another configuration, or a file that it names has changed", dataset,
                    "go on with the folder's own config.toml, or choose another --out");
}

files::CorpusPlan planned(const Run& run) {
    check_finished(run);
    try {
        return corpus_plan(run.config, run.options.folder, run.plan_options());
    } catch (const Error&) {
        // Nothing was made that could be gone on with, unless others are at work here.
        if (!fs::exists(run.file("plan.h5")) && shards_in(run.options.folder).empty()) remove_plan(run.options.folder);
        throw;
    }
}

/// Shards that waited for the plan together come here together, and would write under the same passing name.
void write_config(const Run& run) {
    const files::FileLock lock = files::FileLock::take(run.file("plan.lock"));
    if (!fs::exists(run.file("config.toml"))) files::write_text_file(run.file("config.toml"), run.config.absolute_text);
}

/// What a data set of one shard holds goes back into the shard, where that misses it.
void take_apart(Shard& shard, const std::string& dataset) {
    if (!shard.is_complete() && fs::exists(dataset)) shard.adopt(dataset);
}

void fill(Run& run, const files::CorpusPlan& plan, const std::vector<ShardNumber>& shards) {
    const Shard::Options options{run.config.output.part, run.config.output.compression};
    for (const ShardNumber& number : shards) {
        Shard shard(run.options.folder, number, plan, options);
        if (number.count == 1) take_apart(shard, run.summary.dataset);
        fill_shard(shard, run.config, plan, run.options.folder, run.plan_options());
        run.tally.add(shard.tally());
        run.summary.remarks.insert(run.summary.remarks.end(), shard.remarks().begin(), shard.remarks().end());
    }
}

/// Joins the shards of a whole corpus. One shard alone becomes a plain file and is no longer needed.
void join(const Run& run, const std::vector<ShardNumber>& shards) {
    MergeOptions options;
    options.copy = shards.size() == 1;
    options.trust = true;
    options.progress = run.options.progress;
    const MergeSummary merged = merge(run.options.folder, options);
    if (!merged.missing.empty() || !merged.damaged.empty())
        throw Error(std::to_string(merged.missing.size() + merged.damaged.size()) +
                        " samples were made, but cannot be read again",
                    run.options.folder, "--resume makes them once more");
    if (shards.size() > 1) return;
    fs::remove_all(run.file(shard_folder_name(shards.front())));
    remove_plan(run.options.folder);
    std::error_code not_empty;
    fs::remove(run.file("replay"), not_empty);  // all that failed was made in the end
}

std::uint64_t bytes_on_disk(const std::string& dataset) {
    if (!fs::is_directory(dataset)) return fs::file_size(dataset);
    std::uint64_t bytes = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(dataset)) bytes += entry.file_size();
    return bytes;
}

void summarise(const Run& run, const files::CorpusPlan& plan) {
    const SampleTally& tally = run.tally;
    GenerateSummary& summary = run.summary;
    summary.samples = static_cast<int>(tally.samples);
    summary.accepted = static_cast<int>(tally.accepted);
    summary.climbed = static_cast<int>(tally.climbed);
    summary.failed = tally.failed;
    std::sort(summary.failed.begin(), summary.failed.end(),
              [](const FailedSample& a, const FailedSample& b) { return a.pose < b.pose; });
    summary.vertices = plan.header.mesh.vertex_count();
    summary.triangles = plan.header.mesh.triangle_count();
    if (tally.samples > 0) summary.mean_drape_seconds = tally.drape_seconds / static_cast<double>(tally.samples);
    summary.worst_penetration = tally.worst_penetration;
    summary.worst_stretch = tally.worst_stretch;
    summary.worst_residual = tally.worst_residual;
    summary.bytes = bytes_on_disk(summary.dataset);
    if (!plan.header.image) return;
    summary.image_width = summary.image_height = plan.header.image->size;
    summary.image_channels = 3 * plan.header.image->layers;
    summary.image_error_max = tally.image_error_max;
    summary.image_error_rms = tally.image_error_rms();
}

void make(Run& run, const std::vector<ShardNumber>& shards) {
    const files::CorpusPlan plan = planned(run);
    run.summary.remarks = plan.remarks;
    write_config(run);
    fill(run, plan, shards);
    if (!run.options.shard) join(run, shards);
    summarise(run, plan);
    if (run.options.shard) return;
    write_card(run.summary.dataset, {run.options.command, run.summary.remarks});
    write_xdmf(run.summary.dataset);
}

}  // namespace

GenerateSummary generate(const SceneConfig& config, const GenerateOptions& options) {
    const auto start = Clock::now();
    check_complete(config);
    const OutputFolder folder(options.folder, OutputFolder::For::results);
    const std::vector<ShardNumber> shards = shards_to_fill(options);
    GenerateSummary summary;
    Run run{config, options, summary};
    summary.dataset = options.shard ? run.file(shard_folder_name(*options.shard)) : run.file("dataset.h5");
    try {
        make(run, shards);
    } catch (const Interrupted&) {
        throw Interrupted("interrupted: what was made is kept, and --resume goes on with it");
    }
    summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return summary;
}

}  // namespace toile::generate
