#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/sample_tally.h"
#include "generate/scene_config.h"
#include "generate/shard.h"

namespace toile::generate {

struct GenerateOptions {
    std::string folder;                ///< made if it is not there
    int jobs = 1;                      ///< worker processes; the samples do not depend on it
    std::optional<ShardNumber> shard;  ///< this part alone; else everything
    bool resume = false;               ///< go on with what is in the folder; else Error where there is something
    std::uint64_t memory_limit = 0;    ///< of each worker process [bytes]; 0: none
    ProgressCallback progress;
    std::string command;                             ///< for the data card; may be empty
    const std::atomic<bool>* interrupted = nullptr;  ///< ends the run in order; what is done is kept
};

struct GenerateSummary {
    std::string dataset;  ///< path of the file, or of the shard's folder
    int samples = 0, accepted = 0;
    int climbed = 0;  ///< accepted at a later try than the first
    std::vector<FailedSample> failed;
    int vertices = 0, triangles = 0;
    std::uintmax_t bytes = 0;                                             ///< size of the data set on disk [B]
    double seconds = 0;                                                   ///< wall time of the whole run [s]
    double mean_drape_seconds = 0;                                        ///< wall time of one sample's drape [s]
    double worst_penetration = 0, worst_stretch = 0, worst_residual = 0;  ///< over the accepted samples
    int image_width = 0, image_height = 0, image_channels = 0;            ///< zero without [image]
    double image_error_max = 0, image_error_rms = 0;                      ///< mesh to image to mesh [m]
    std::vector<std::string> remarks;  ///< what was mended or estimated on the way, one sentence each
};

/// Poses, skin, simulate, embed, rasterise. Everything (no `shard`): writes `folder`/dataset.h5, whole or not at all.
/// Beside
/// it CARD.md (`write_card`). One shard: fills `folder`/shard_00003_of_00016, see `Shard`; `merge` joins them. Beside
/// them config.toml and, for each pose that failed, replay/pose_000123.h5.
///
/// Sample k depends on the configuration and k alone; the data set's bytes depend neither on `jobs` nor on shards, the
/// order or the clock. The work is done in child processes: one that crashes or runs out of memory costs its sample a
/// second try, then that sample alone, which is stored as failed. So call it before this process has started threads.
/// Killed at any moment, a run loses the samples in work at most; `resume` goes on. With `resume` and no `shard`, a
/// folder that holds shards has the gaps in all of them filled.
///
/// Throws Error where the folder cannot be used: unwritable, filled with unfinished work (without `resume`), another
/// configuration's, or another process at work on the shard.
GenerateSummary generate(const SceneConfig& config, const GenerateOptions& options);

}  // namespace toile::generate
