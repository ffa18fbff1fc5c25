#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace toile::generate {

/// What a worker says of its shard every few seconds: DIR/shard_00003_of_00016/progress.json.
struct ShardProgress {
    int shard = 0, shards = 1;
    std::int64_t samples = 0;                    ///< in the shard
    std::int64_t done = 0, accepted = 0;         ///< in all, by whichever process
    std::map<std::string, std::int64_t> failed;  ///< reason -> samples
    std::int64_t made_here = 0;                  ///< by the process that wrote this
    double seconds_here = 0;                     ///< since it began [s], by a clock that nobody can set
    std::int64_t pid = 0;
    std::string host;
    std::string state = "running";  ///< running, finished, stopped
    std::int64_t updated = 0;       ///< [s] since 1970, for people; nothing is worked out from it
};

/// Replaces the file. Throws Error where it cannot be written.
void write_shard_progress(const std::string& path, const ShardProgress& progress);
/// Throws Error where it cannot be read or is not one.
ShardProgress read_shard_progress(const std::string& path);

}  // namespace toile::generate
