#include "generate/corpus_plan.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "cloth/error.h"
#include "files/file_lock.h"
#include "files/journal.h"
#include "files/sample_bytes.h"
#include "generate/dataset_header.h"
#include "generate/sample_maker.h"
#include "generate/worker_pool.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view plan_name = "plan.h5", draft_name = "plan.dressed.h5", lock_name = "plan.lock",
                           probe_name = "probe";

std::string in(const std::string& folder, std::string_view name) {
    return (fs::path(folder) / name).string();
}

void check_owner(const files::CorpusPlan& plan, const SceneConfig& config, const std::string& path) {
    if (plan.header.config_hash != config.hash)
        throw Error("this folder's data are of another configuration, or a file that it names has changed", path,
                    "go on with the folder's own config.toml, or choose another --out");
    if (plan.header.program_version != TOILE_VERSION)
        throw Error(
            "this folder's data were begun by toile " + plan.header.program_version + ", this is " + TOILE_VERSION,
            path, "finish with that version, or choose another --out");
}

WorkerPoolOptions pool(const PlanOptions& options, int workers, const files::FileLock& lock) {
    WorkerPoolOptions pool;
    pool.parents_descriptor = {lock.descriptor()};
    pool.workers = workers;
    pool.memory_limit = options.memory_limit;
    pool.interrupted = options.interrupted;
    return pool;
}

/// Runs one piece of work in a child process, so that this one starts no threads and keeps little memory.
void in_a_child(const std::string& what, const PlanOptions& options, const files::FileLock& lock,
                const std::function<void()>& work) {
    if (options.progress) options.progress({what, 0, 0, 0});
    run_in_workers(
        {0}, pool(options, 1, lock),
        [&] {
            return [&](int) {
                work();
                return std::string();
            };
        },
        [&](const WorkResult& result) {
            if (result.failure)
                throw Error("the process that was " + what + " ended early: " + result.detail, {},
                            "toile simulate shows the drape in the neutral pose; see --memory-limit too");
        },
        {});
}

void write_dressed(const SceneConfig& config, const std::string& path) {
    const DressedScene dressed = dress(build_scene(config));
    files::CorpusPlan plan;
    plan.pose_number = dressed.scene.pose_number;
    const skin::PoseSplits splits = dressed.scene.poses->splits(plan.pose_number, config.split);
    for (const skin::Split split : splits.split) plan.split.push_back(static_cast<int>(split));
    plan.remarks = dressed.scene.remarks;
    for (std::string& remark : skin::split_remarks(splits, config.split)) plan.remarks.push_back(std::move(remark));
    const bool sized = config.image && config.image->size > 0;
    std::unique_ptr<pattern::PatternImage> image;
    if (sized)
        image =
            std::make_unique<pattern::PatternImage>(dressed.mesh, dressed.scene.garment.triangle_panel, *config.image);
    plan.header = dataset_header(dressed, image.get());
    files::write_plan(path, plan);
}

/// Adds the images' layout to the plan, at the size that serves the probe.
void write_sized(const SceneConfig& config, const std::string& folder, files::CorpusPlan plan) {
    std::vector<Positions> displacement;
    for (const auto& [slot, bytes] : probed_samples(folder, plan)) {
        files::SampleRecord sample = files::sample_from_bytes(bytes);
        if (sample.status == 0) displacement.push_back(std::move(sample.displacement));
    }
    const DressedScene dressed = dress_again(build_scene(config), plan.header.mesh.rest_position);
    pattern::ImageOptions options = *config.image;
    const std::vector<int>& panel = dressed.scene.garment.triangle_panel;
    const pattern::AutoImageSize fit = pattern::auto_image_size(dressed.mesh, panel, options, displacement);
    if (!fit.reached) plan.remarks.push_back("image.max_error is not reached, not even by the largest image");
    options.size = fit.size;
    const pattern::PatternImage image(dressed.mesh, panel, options);
    plan.header = dataset_header(dressed, &image);
    files::write_plan(in(folder, plan_name), plan);
}

/// Drapes the poses of the probe that are not there yet.
void drape_probe(const SceneConfig& config, const std::string& folder, const files::CorpusPlan& plan,
                 const PlanOptions& options, const files::FileLock& lock) {
    std::vector<int> missing;
    const std::map<int, std::string> there = probed_samples(folder, plan);
    for (const int slot : probe_slots(plan.sample_count(), config.image->probe))
        if (!there.count(slot)) missing.push_back(slot);
    if (there.empty()) fs::remove(in(folder, probe_name));  // whatever is in it cannot be told to be this corpus'
    files::Journal journal(in(folder, probe_name));
    if (journal.count() == 0) journal.append(config.hash);
    int done = 0;
    const auto report = [&] {
        if (options.progress)
            options.progress({"draping poses to size the images on", done, static_cast<int>(missing.size()), 0});
    };
    report();
    run_in_workers(
        missing, pool(options, options.jobs, lock),
        [&] {
            const auto maker = std::make_shared<SampleMaker>(config, plan, folder);
            return [maker](int slot) { return files::sample_bytes(maker->make(slot)); };
        },
        [&](const WorkResult& result) {
            ++done;
            if (!result.failure) journal.append(result.bytes);  // who crashes here has another chance as a sample
            report();
        },
        {});
}

files::CorpusPlan readable_plan(const std::string& path) {
    try {
        return files::read_plan(path);
    } catch (const Error& error) {
        throw Error(std::string("the plan of this corpus cannot be read: ") + error.what(), path,
                    "remove it: --resume works it out again, to the same");
    }
}

files::CorpusPlan usable_plan(const SceneConfig& config, const std::string& path) {
    files::CorpusPlan plan = readable_plan(path);
    check_owner(plan, config, path);
    return plan;
}

}  // namespace

std::vector<int> probe_slots(int samples, int probe) {
    const int count = std::min(samples, probe);
    std::vector<int> slot;
    for (int i = 0; i < count; ++i) slot.push_back(static_cast<int>(std::int64_t{i} * samples / count));
    return slot;
}

std::map<int, std::string> probed_samples(const std::string& folder, const files::CorpusPlan& plan) {
    std::map<int, std::string> sample;
    const std::string path = in(folder, probe_name);
    if (!fs::exists(path)) return sample;
    const files::Journal journal(path);
    if (journal.count() == 0 || journal.read(0) != plan.header.config_hash) return sample;
    std::map<std::int64_t, std::string> of_pose;
    for (int k = 1; k < journal.count(); ++k) {
        std::string bytes = journal.read(k);
        const std::int64_t pose = files::sample_from_bytes(bytes).id;
        of_pose[pose] = std::move(bytes);
    }
    for (int slot = 0; slot < plan.sample_count(); ++slot) {
        const auto found = of_pose.find(plan.pose_number[slot]);
        if (found != of_pose.end()) sample[slot] = found->second;
    }
    return sample;
}

files::CorpusPlan corpus_plan(const SceneConfig& config, const std::string& folder, const PlanOptions& options) {
    const std::string path = in(folder, plan_name), draft = in(folder, draft_name);
    const files::FileLock lock = files::FileLock::take(in(folder, lock_name));
    if (fs::exists(path)) return usable_plan(config, path);
    const bool probed = config.image && config.image->size == 0;
    if (!probed || !fs::exists(draft))
        in_a_child("dressing the body in its neutral pose", options, lock,
                   [&] { write_dressed(config, probed ? draft : path); });
    if (probed) {
        const files::CorpusPlan dressed = usable_plan(config, draft);
        drape_probe(config, folder, dressed, options, lock);
        in_a_child("choosing the size of the images", options, lock, [&] { write_sized(config, folder, dressed); });
        fs::remove(draft);
    }
    return usable_plan(config, path);
}

void remove_plan(const std::string& folder) {
    for (const std::string_view name : {plan_name, draft_name, probe_name, lock_name}) {
        std::error_code ignored;
        fs::remove(in(folder, name), ignored);
    }
}

}  // namespace toile::generate
