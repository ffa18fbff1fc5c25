#pragma once

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

struct ImageSweep {
    std::vector<int> size = {32, 48, 64, 96, 128, 192, 256, 384, 512};  ///< [pixels], 16 to 4096
};

/// Error of displacements read back from their images by image size, against the time to write and read one. A size
/// that leaves a panel no room is left out and said; so is the study of a data set without displacements.
Study study_images(const RuntimeSamples& samples, const ImageSweep& sweep, const RepeatOptions& repeat,
                   const Clock& clock);

}  // namespace toile::evaluate
