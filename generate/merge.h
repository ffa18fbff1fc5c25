#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/sample_tally.h"

namespace toile::generate {

struct MergeOptions {
    bool copy = false;
    int jobs = 1;
    ProgressCallback progress;
};

struct MergeSummary {
    std::string dataset;
    int samples = 0, accepted = 0;
    std::vector<FailedSample> failed;
    std::vector<std::int64_t> missing;
    std::vector<std::string> damaged;
};

MergeSummary merge(const std::string& folder, const MergeOptions& options);

}  // namespace toile::generate
