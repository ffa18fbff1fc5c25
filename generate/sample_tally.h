#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "files/dataset_file.h"

namespace toile::generate {

struct FailedSample {
    std::int64_t pose;
    std::string reason;
    std::string replay;  ///< the file that `toile simulate --replay` runs again
};

/// What a run says of its samples.
struct SampleTally {
    std::int64_t samples = 0, accepted = 0;
    std::int64_t climbed = 0;  ///< accepted at a later try than the first
    std::vector<FailedSample> failed;
    double drape_seconds = 0;                                             ///< sum of the wall times of the drapes [s]
    double worst_penetration = 0, worst_stretch = 0, worst_residual = 0;  ///< over the accepted samples
    double image_error_max = 0, image_error_square = 0;  ///< over the accepted: largest [m], sum of mean squares [m²]

    /// `folder`: that of the corpus, where replay/ is.
    void add(const files::SampleRecord& sample, const std::string& folder);
    void add(const SampleTally& other);
    std::map<std::string, std::int64_t> failed_by_reason() const;
    double image_error_rms() const;
};

/// DIR/replay/pose_000123.h5
std::string replay_path(const std::string& folder, std::int64_t pose);

}  // namespace toile::generate
