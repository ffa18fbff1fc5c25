#include "generate/corpus_status.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/file_lock.h"
#include "files/hdf5_file.h"
#include "generate/shard_progress.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

constexpr std::array state_name{"not begun", "running", "stopped", "stale", "finished"};

/// What a shard says of itself; nothing where it has not said anything yet.
std::optional<ShardProgress> progress_in(const fs::path& folder) {
    const fs::path path = folder / "progress.json";
    if (!fs::exists(path)) return std::nullopt;
    try {
        return read_shard_progress(path.string());
    } catch (const Error&) {  // damaged: the shard's next heartbeat replaces it
        return std::nullopt;
    }
}

ShardState state_of(const std::optional<ShardProgress>& said, bool held) {
    if (held) return ShardState::running;
    if (!said) return ShardState::stopped;
    if (said->state == "running") return ShardState::stale;
    return said->state == "finished" && said->done >= said->samples ? ShardState::finished : ShardState::stopped;
}

ShardStatus status_of(const fs::path& corpus, ShardNumber number, int samples) {
    ShardStatus status;
    status.number = number;
    status.samples = shard_slots(number, samples).size();
    const fs::path folder = corpus / shard_folder_name(number);
    if (!fs::exists(folder)) return status;
    const std::optional<ShardProgress> said = progress_in(folder);
    status.state = state_of(said, files::FileLock::is_held((folder / "lock").string()));
    if (!said) return status;
    status.done = said->done;
    status.accepted = said->accepted;
    status.failed = said->failed;
    status.host = said->host;
    status.pid = said->pid;
    if (status.state == ShardState::running && said->state == "running" && said->seconds_here > 0)
        status.rate = static_cast<double>(said->made_here) / said->seconds_here;
    return status;
}

/// The shards share the work that is left, and one alone may take longest.
std::optional<double> seconds_left(const CorpusStatus& status) {
    const auto left = [](const auto& of) { return static_cast<double>(of.samples - of.done); };
    if (status.samples == status.done) return 0.0;
    if (!(status.rate > 0)) return std::nullopt;
    double seconds = left(status) / status.rate;
    for (const ShardStatus& one : status.shard)
        if (one.rate > 0) seconds = std::max(seconds, left(one) / one.rate);
    return seconds;
}

void add_up(CorpusStatus& status) {
    for (const ShardStatus& one : status.shard) {
        status.samples += one.samples;
        status.done += one.done;
        status.accepted += one.accepted;
        status.rate += one.rate;
        for (const auto& [reason, count] : one.failed) status.failed[reason] += count;
    }
}

/// The counts of a data set that is whole by itself.
void count_dataset(const std::string& path, CorpusStatus& status) {
    const files::Hdf5File file = files::Hdf5File::open(path);
    const std::vector<std::string> reason = file.strings_attribute("/samples/status", "reasons");
    for (const int one : file.read<int>("/samples/status", {files::any_size}).value) {
        ++status.samples;
        if (one == 0)
            ++status.accepted;
        else
            ++status.failed[one > 0 && one < static_cast<int>(reason.size()) ? reason[one] : "unknown reason"];
    }
    status.done = status.samples;
}

/// All shards of the division that was begun.
std::vector<ShardStatus> shards_of(const std::string& folder, const std::vector<ShardNumber>& there) {
    if (there.front().count != there.back().count)
        throw Error("the folder holds shards of two divisions, into " + std::to_string(there.front().count) +
                        " and into " + std::to_string(there.back().count),
                    folder, "keep the shards of one division here and move the others elsewhere");
    const files::Hdf5File plan = files::Hdf5File::open((fs::path(folder) / "plan.h5").string());
    const files::Shape shape = plan.shape("/plan/pose_number");
    const int samples = shape.size() == 1 ? static_cast<int>(shape[0]) : 0;
    std::vector<ShardStatus> shard;
    for (int index = 0; index < there.front().count; ++index)
        shard.push_back(status_of(folder, {index, there.front().count}, samples));
    return shard;
}

}  // namespace

std::string_view shard_state_name(ShardState state) {
    return state_name[static_cast<size_t>(state)];
}

int CorpusStatus::count(ShardState state) const {
    return static_cast<int>(
        std::count_if(shard.begin(), shard.end(), [&](const ShardStatus& one) { return one.state == state; }));
}

CorpusStatus corpus_status(const std::string& folder) {
    CorpusStatus status;
    status.folder = folder;
    const std::string dataset = (fs::path(folder) / "dataset.h5").string();
    const std::vector<ShardNumber> there = shards_in(folder);
    if (!there.empty()) {
        status.shard = shards_of(folder, there);
        add_up(status);
        status.seconds_left = seconds_left(status);
    } else if (fs::exists(dataset)) {
        count_dataset(dataset, status);
        status.seconds_left = 0.0;
    } else if (files::FileLock::is_held((fs::path(folder) / "plan.lock").string())) {
        status.planning = true;
    } else if (fs::exists(fs::path(folder) / "plan.h5")) {
        status.samples =
            files::Hdf5File::open((fs::path(folder) / "plan.h5").string()).shape("/plan/pose_number").at(0);
    } else {
        throw Error("there is no corpus in this folder", folder, "give the folder that toile generate writes to");
    }
    if (fs::exists(dataset)) status.dataset_samples = files::Hdf5File::open(dataset).shape("/samples/id").at(0);
    return status;
}

std::string status_json(const CorpusStatus& status) {
    nlohmann::ordered_json json{{"folder", status.folder},     {"planning", status.planning},
                                {"samples", status.samples},   {"done", status.done},
                                {"accepted", status.accepted}, {"failed", status.failed},
                                {"rate", status.rate},         {"seconds_left", nullptr},
                                {"dataset_samples", nullptr},  {"shards", nlohmann::ordered_json::array()}};
    if (status.seconds_left) json["seconds_left"] = *status.seconds_left;
    if (status.dataset_samples) json["dataset_samples"] = *status.dataset_samples;
    for (const ShardStatus& one : status.shard)
        json["shards"].push_back({{"shard", one.number.index},
                                  {"state", shard_state_name(one.state)},
                                  {"samples", one.samples},
                                  {"done", one.done},
                                  {"accepted", one.accepted},
                                  {"failed", one.failed},
                                  {"rate", one.rate},
                                  {"host", one.host},
                                  {"pid", one.pid}});
    return json.dump(2);
}

}  // namespace toile::generate
