#include "generate/validate_recompute.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <random>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/new_file.h"
#include "generate/sample_maker.h"
#include "generate/worker_pool.h"
#include "simulate/certificate.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

/// A folder that goes with the object.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string name = (fs::temp_directory_path() / "toile_recompute_XXXXXX").string();
        if (!mkdtemp(name.data())) throw Error("no temporary folder can be made", fs::temp_directory_path().string());
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

/// The scene a data set was made from, or an Error that says why it cannot be had.
SceneConfig config_of(const std::string& dataset, const files::DatasetHeader& header) {
    const fs::path folder = fs::absolute(dataset).parent_path();
    std::string gone, changed;
    const auto fits = [&](const auto& read, SceneConfig& config) {
        try {
            config = read();
            if (config.hash == header.config_hash) return true;
            if (changed.empty()) changed = config.file;
        } catch (const Error& error) {
            if (gone.empty()) gone = error.what() + (error.where().empty() ? "" : " (" + error.where() + ")");
        }
        return false;
    };
    SceneConfig config;
    for (const fs::path& path : {folder / "config.toml", folder.parent_path() / "config.toml"})
        if (fs::exists(path) && fits([&] { return read_scene(path.string(), {}); }, config)) return config;
    if (fits([&] { return read_scene_text(header.config, dataset, {}); }, config)) return config;
    if (!changed.empty())
        throw Error(
            "samples cannot be made again: the configuration, or a file that it names, is not what the data "
            "set was made from",
            changed, "the data set's config_hash is " + header.config_hash);
    throw Error("samples cannot be made again: " + gone, dataset,
                "put the configuration's files back, or call toile from the folder its paths are relative to");
}

std::vector<int> chosen_slots(const RecomputeChoice& choice, const files::DatasetHeader& header, int samples) {
    const double wanted = choice.count > 0 ? static_cast<double>(choice.count) : std::ceil(choice.share * samples);
    std::vector<int> all(static_cast<size_t>(samples)), chosen;
    std::iota(all.begin(), all.end(), 0);
    std::mt19937_64 random(static_cast<std::uint64_t>(header.seed) + 1);
    std::sample(all.begin(), all.end(), std::back_inserter(chosen), static_cast<std::ptrdiff_t>(wanted), random);
    return chosen;
}

files::CorpusPlan plan_of(const files::DatasetReader& reader) {
    files::CorpusPlan plan;
    plan.header = reader.header();
    plan.pose_number = reader.file().read<std::int64_t>("/samples/id", {files::any_size}).value;
    for (const std::int8_t split : reader.file().read<std::int8_t>("/samples/split", {files::any_size}).value)
        plan.split.push_back(split);
    return plan;
}

std::string reason_of(const files::DatasetHeader& header, int status) {
    const bool known = status >= 0 && status < static_cast<int>(header.reasons.size());
    return known ? header.reasons[static_cast<size_t>(status)] : "status " + std::to_string(status);
}

/// Status and digest of a sample, as a worker sends them.
std::string outcome(const files::SampleRecord& sample) {
    const files::Digest digest = files::sample_digest(sample);
    return static_cast<char>(sample.status) + std::string(digest.begin(), digest.end());
}

}  // namespace

RecomputeChoice recompute_choice(const std::string& text) {
    RecomputeChoice choice;
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    std::string unit(end);
    std::erase(unit, ' ');
    if (unit == "%" && value > 0 && value <= 100) {
        choice.share = value / 100;
    } else if (unit.empty() && value >= 1 && value <= 1e9 && value == std::floor(value)) {
        choice.count = static_cast<std::int64_t>(value);
    } else {
        throw Error("\"" + text + "\" is neither a share such as 1% nor a number of samples", "--recompute");
    }
    return choice;
}

void recompute_samples(const std::string& dataset, const ValidateOptions& options, Validation& result) {
    const files::DatasetReader reader(dataset);
    const files::DatasetHeader& header = reader.header();
    const SceneConfig config = config_of(dataset, header);
    if (header.program_version != TOILE_VERSION)
        result.remark.push_back("the data set is of toile " + header.program_version + ", this is " + TOILE_VERSION +
                                ": its samples may come out otherwise");
    const files::CorpusPlan plan = plan_of(reader);
    const std::vector<int> slot = chosen_slots(*options.recompute, header, reader.sample_count());
    const std::vector<int> status = reader.file().read<int>("/samples/status", {files::any_size}).value;
    const ScratchFolder scratch;
    WorkerPoolOptions pool;
    pool.workers = std::max(options.jobs, 1);
    int done = 0;
    std::vector<std::pair<int, std::string>> differs;
    run_in_workers(
        slot, pool,
        [&] {
            const auto maker = std::make_shared<SampleMaker>(config, plan, scratch.path());
            return [maker](int one) { return outcome(maker->make(one)); };
        },
        [&](const WorkResult& work) {
            const std::string stored = reason_of(header, status[work.index]);
            const files::Digest digest = reader.stored_digest(work.index);
            const std::string ended = work.failure == WorkerFailure::crashed ? "crashed" : "out_of_memory";
            if (work.failure && stored != ended)
                differs.emplace_back(work.index, stored + ", and made again " + ended + ": " + work.detail);
            if (!work.failure &&
                !std::equal(digest.begin(), digest.end(), reinterpret_cast<const std::uint8_t*>(work.bytes.data()) + 1))
                differs.emplace_back(work.index, stored + ", and made again " + reason_of(header, work.bytes[0]));
            if (options.step) options.step(++done, static_cast<int>(slot.size()));
        });
    std::sort(differs.begin(), differs.end());
    for (const auto& [at, what] : differs)
        result.defect.push_back("/samples/digest[" + std::to_string(at) + "]: pose " +
                                std::to_string(plan.pose_number[at]) + " made again is another sample: it is stored " +
                                what);
    result.recomputed = static_cast<int>(slot.size());
}

}  // namespace toile::generate
