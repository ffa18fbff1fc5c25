#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cloth/topology.h"
#include "files/dataset_file.h"
#include "pattern/rasterizer.h"
#include "skin/body.h"

namespace toile::generate {

/// What the checks of all samples share.
struct SampleChecker {
    /// The header must be sound: indices in range, pattern pixels inside the image.
    explicit SampleChecker(const files::DatasetHeader& header);

    /// Everything wrong with sample `slot`.
    std::vector<std::string> defects(const files::SampleRecord& sample, const files::Digest& stored, int slot) const;

    const files::DatasetHeader& header;
    std::optional<skin::Body> body;
    Topology topology;
    Eigen::VectorXd rest_length;  ///< `[E]`
    pattern::PixelWeights reading;
};

}  // namespace toile::generate
