#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/scene_config.h"

namespace toile::generate {

struct GenerateOptions {
    std::string folder;  ///< made if it is not there; Error if it holds a data set already
    int jobs = 1;        ///< samples worked on side by side; the files do not depend on it
    ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between samples
};

struct FailedSample {
    std::int64_t pose;
    std::string reason;
    std::string replay;  ///< the file that `toile simulate --replay` runs again
};

struct GenerateSummary {
    std::string dataset;  ///< path of the file
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

/// Poses, skin, simulate, embed, rasterise: writes `folder`/dataset.h5, whole or not at all, and beside it config.toml
/// and, for each pose that failed, replay/pose_000123.h5.
/// Sample k depends on the configuration and k alone, and the file's bytes on neither `jobs` nor the clock. Throws
/// Error before any work where the folder cannot be used.
GenerateSummary generate(const SceneConfig& config, const GenerateOptions& options);

}  // namespace toile::generate
