#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "generate/shard.h"

namespace toile::generate {

/// - stale: says that it is running, but no process holds its lock, as after a kill.
/// - stopped: ended in order before it was through.
enum class ShardState { not_begun, running, stopped, stale, finished };
std::string_view shard_state_name(ShardState state);  ///< "not begun", "running" ...

struct ShardStatus {
    ShardNumber number;
    ShardState state = ShardState::not_begun;
    std::int64_t samples = 0, done = 0, accepted = 0;
    std::map<std::string, std::int64_t> failed;  ///< reason -> samples
    double rate = 0;                             ///< [samples/s] of the process at work, by its own clock; 0 if unknown
    std::string host;                            ///< where the last process ran
    std::int64_t pid = 0;
};

/// How far a corpus has come.
struct CorpusStatus {
    std::string folder;
    bool planning = false;           ///< the plan is being made; nothing else is known yet
    std::vector<ShardStatus> shard;  ///< all of them, in order; empty for a data set that is whole
    std::int64_t samples = 0, done = 0, accepted = 0;
    std::map<std::string, std::int64_t> failed;
    double rate = 0;                              ///< [samples/s] over the shards that run
    std::optional<double> seconds_left;           ///< [s] at that rate; nothing where it is not known
    std::optional<std::int64_t> dataset_samples;  ///< in dataset.h5, where there is one

    int count(ShardState state) const;
};

/// Looks at the folder of `generate`, whether it is at work, has finished, or was merged; changes nothing in it. What
/// shards say of themselves is a few seconds old. Throws Error for a folder without a corpus.
CorpusStatus corpus_status(const std::string& folder);

/// All of it, for scripts: one JSON object.
std::string status_json(const CorpusStatus& status);

}  // namespace toile::generate
