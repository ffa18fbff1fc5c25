#pragma once

#include "evaluate/runtime_samples.h"
#include "evaluate/study.h"

namespace toile::evaluate {

/// What the studies of the priors sweep.
struct PriorSweep {
    std::vector<double> tolerance = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
    std::vector<int> sweeps = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000};  ///< of position-based projection
};

/// Error of each method in prior/ at each tolerance, and of position-based projection after each number of sweeps,
/// against seconds a sample. The error is the distance to a certified reference (evaluate/studied_prior.h); samples
/// without one are refused. One sample at a time, one thread.
Study study_priors(const RuntimeSamples& samples, const PriorSweep& sweep, const RepeatOptions& repeat,
                   const Clock& clock);

/// The same of ∂E/∂r̂, E = Σ_i |r*_i − r_T,i|²: relative error |g − g'| / |g'| of the projection to a tolerance and its
/// backward pass, against the seconds of both. Position-based projection has no gradient.
Study study_gradients(const RuntimeSamples& samples, const PriorSweep& sweep, const RepeatOptions& repeat,
                      const Clock& clock);

}  // namespace toile::evaluate
