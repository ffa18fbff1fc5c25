#include "generate/shard_work.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "cloth/error.h"
#include "files/sample_bytes.h"
#include "generate/sample_maker.h"
#include "generate/shard_progress.h"
#include "generate/worker_pool.h"

namespace toile::generate {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double seconds_between_heartbeats = 5.0;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// progress.json of a shard at work.
class Heartbeat {
  public:
    explicit Heartbeat(const Shard& shard) : shard_(shard), done_before_(shard.tally().samples), host_(host_name()) {
        beat("running");
    }

    void beat_if_due() {
        if (seconds_since(last_) >= seconds_between_heartbeats) beat("running");
    }

    void beat(const std::string& state) {
        last_ = Clock::now();
        const SampleTally& tally = shard_.tally();
        ShardProgress progress;
        progress.shard = shard_.number().index;
        progress.shards = shard_.number().count;
        progress.samples = shard_.slots().size();
        progress.done = tally.samples;
        progress.accepted = tally.accepted;
        progress.failed = tally.failed_by_reason();
        progress.made_here = tally.samples - done_before_;
        progress.seconds_here = seconds_since(start_);
        progress.pid = ::getpid();
        progress.host = host_;
        progress.state = state;
        progress.updated =
            std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
                .count();
        write_shard_progress((std::filesystem::path(shard_.folder()) / "progress.json").string(), progress);
    }

  private:
    const Shard& shard_;
    const std::int64_t done_before_;
    const std::string host_;
    const Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

/// A slot that no worker could make.
struct LostSlot {
    int slot;
    simulate::DrapeStatus status;
};

/// One filling of a shard: what its stages share.
struct Filling {
    Shard& shard;
    const SceneConfig& config;
    const files::CorpusPlan& plan;
    const std::string& folder;
    const PlanOptions& options;
    Heartbeat heartbeat{shard};
    std::vector<LostSlot> lost = {};

    void report() const {
        if (options.progress)
            options.progress({"draping", static_cast<int>(shard.tally().samples), shard.slots().size(),
                              static_cast<int>(shard.tally().failed.size() + lost.size())});
    }

    WorkerPoolOptions pool(int workers) const {
        WorkerPoolOptions pool;
        pool.workers = workers;
        pool.memory_limit = options.memory_limit;
        pool.interrupted = options.interrupted;
        pool.parents_descriptor = {shard.lock_descriptor()};
        return pool;
    }

    void add(int slot, const std::string& bytes) {
        shard.add(slot, bytes);
        heartbeat.beat_if_due();
        report();
    }
};

/// In a worker: samples that planning has draped already are only rasterised.
MakeBytes start_maker(Filling& filling) {
    const auto maker = std::make_shared<SampleMaker>(filling.config, filling.plan, filling.folder);
    const auto probed = std::make_shared<std::map<int, std::string>>(probed_samples(filling.folder, filling.plan));
    return [maker, probed](int slot) {
        const auto found = probed->find(slot);
        if (found == probed->end()) return files::sample_bytes(maker->make(slot));
        files::SampleRecord sample = files::sample_from_bytes(found->second);
        maker->rasterise(sample);
        return files::sample_bytes(sample);
    };
}

void make_samples(Filling& filling, const std::vector<int>& slot) {
    run_in_workers(
        slot, filling.pool(std::min(filling.options.jobs, static_cast<int>(slot.size()))),
        [&] { return start_maker(filling); },
        [&](const WorkResult& result) {
            if (!result.failure) return filling.add(result.index, result.bytes);
            const bool memory = *result.failure == WorkerFailure::out_of_memory;
            filling.lost.push_back(
                {result.index, memory ? simulate::DrapeStatus::out_of_memory : simulate::DrapeStatus::crashed});
            filling.report();
        },
        [&] { filling.heartbeat.beat_if_due(); });
}

/// Stores what can be said of the lost slots, from a process of its own: their poses may be what was too much.
void store_lost(Filling& filling) {
    std::map<int, simulate::DrapeStatus> status;
    std::vector<int> slot;
    for (const LostSlot& one : filling.lost) {
        status[one.slot] = one.status;
        slot.push_back(one.slot);
    }
    WorkerPoolOptions unlimited = filling.pool(1);
    unlimited.memory_limit = 0;
    run_in_workers(
        slot, unlimited,
        [&]() -> MakeBytes {
            const auto maker = std::make_shared<SampleMaker>(filling.config, filling.plan, filling.folder);
            return [maker, &status](int one) { return files::sample_bytes(maker->lost(one, status.at(one))); };
        },
        [&](const WorkResult& result) {
            if (result.failure)
                throw Error("pose " + std::to_string(filling.plan.pose_number[result.index]) +
                                " ends every process that looks at it: " + result.detail,
                            filling.shard.folder(), "leave it out: poses.number lists the poses wanted");
            filling.add(result.index, result.bytes);
        },
        {});
    filling.lost.clear();
}

}  // namespace

void fill_shard(Shard& shard, const SceneConfig& config, const files::CorpusPlan& plan, const std::string& folder,
                const PlanOptions& options) {
    Filling filling{shard, config, plan, folder, options};
    filling.report();
    try {
        const std::vector<int> missing = shard.missing();
        if (!missing.empty()) make_samples(filling, missing);
        if (!filling.lost.empty()) store_lost(filling);
    } catch (...) {
        try {
            filling.heartbeat.beat("stopped");
        } catch (const Error&) {  // what stopped the work is the news
        }
        throw;
    }
    filling.heartbeat.beat("finished");
}

}  // namespace toile::generate
