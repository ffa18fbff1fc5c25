#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/scene_config.h"

namespace toile::evaluate {

/// One way to drape a scene once more, that ought to give the same cloth.
struct NoiseVariant {
    std::string name, what;
    generate::SceneConfig config;
};

/// Half the step (time and joints), a finer tolerance (of rest and of path steps, with the iterations it takes), and
/// the second solver: `xpbd`, or `implicit` where that is not the configured one.
std::vector<NoiseVariant> noise_variants(const generate::SceneConfig& config);

struct NoiseOptions {
    std::string source;  ///< a configuration or a data set
    std::vector<std::string> overrides;
    std::string folder;  ///< made if it is not there; noise.h5 and noise.json in it are replaced
    double share = 0.1;  ///< of the poses, above 0 to 1
    int jobs = 1;        ///< poses worked on side by side; the files do not depend on it, but for the seconds
    generate::ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between poses
};

/// Over samples and vertices [m].
struct NoiseStatistics {
    std::string name;
    int samples = 0;   ///< that both drapes of a pair brought within the gate: others don't count
    int accepted = 0;  ///< drapes of this variant within the gate
    double median = 0, percentile_95 = 0, percentile_99 = 0, largest = 0, root_mean_square = 0;
    double seconds = 0;  ///< mean wall time of a drape
};

struct NoiseSummary {
    std::string file, results;   ///< paths of noise.h5 and noise.json
    int poses = 0, samples = 0;  ///< there are, and were draped
    int vertices = 0;
    int configured = 0;             ///< samples that the configured drape brought within the gate
    double configured_seconds = 0;  ///< mean wall time of a configured drape
    std::vector<NoiseStatistics> variant;
    NoiseStatistics spread;            ///< of the largest distance over the variants
    std::vector<std::string> missing;  ///< variants that could not be had: "name: why"
    double seconds = 0;                ///< of the whole run
};

/// The simulator's own error: drapes a share of the poses, drawn by the scene's seed, as configured and in each
/// variant, everything made anew, the neutral drape too. A vertex' distance is that between its two places; its spread
/// is the largest distance over the variants that rest within the gate, NaN where none does or the configured drape
/// doesn't. No improvement smaller than this can be claimed.
///
/// Writes noise.h5 (files/noise_file.h) and noise.json (a metric file, files/metric_file.h, with members of its own),
/// whole or not at all. Throws Error for what is wrong with the source, the folder or the share.
NoiseSummary measure_noise(const NoiseOptions& options);

}  // namespace toile::evaluate
