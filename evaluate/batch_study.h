#pragma once

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

struct BatchSweep {
    std::vector<int> batch = {1, 2, 4, 8, 16, 32, 64};
    std::vector<int> threads;  ///< empty: 1, 2, 4 ... up to twice the machine's cores
};

/// Seconds a sample of the default method of each prior, projection and backward pass, by batch size and threads. The
/// samples are taken again from the start where a batch is larger than there are. `clock` is for one thread, `wall` for
/// several.
Study study_batches(const RuntimeSamples& samples, const BatchSweep& sweep, const RepeatOptions& repeat,
                    const Clock& clock, const Clock& wall);

}  // namespace toile::evaluate
