#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "generate/progress.h"
#include "generate/project_config.h"

namespace toile::generate {

struct ProjectOptions {
    std::string problem, out;  ///< files
    bool gradient = false;     ///< of E = Σ_i |r*_i − r_T,i|²; Error if the problem has no target
    int jobs = 1;              ///< threads; the results do not depend on it
    ProgressCallback progress;
    const std::atomic<bool>* interrupted = nullptr;  ///< checked between batches
};

/// A sample with something to say about it.
struct SampleRemark {
    std::int64_t sample;
    std::string text;
};

struct ProjectSummary {
    std::int64_t samples = 0, converged = 0;
    std::vector<SampleRemark> failed;    ///< rejected, accuracy not reached, or without a target to differentiate to
    std::vector<SampleRemark> doubtful;  ///< solved, but the gradient may be off
    int vertices = 0;
    std::int64_t edges = 0;
    double worst_residual = 0;  ///< over the samples that were not rejected
    int most_iterations = 0;
    double seconds = 0;  ///< wall time of the whole run [s]
    // Sums over the samples of the times in their reports [s].
    double forward = 0, sweep = 0, assembly = 0, factor = 0, solve = 0, backward = 0;
    bool gradient = false;
    std::int64_t near_kink =
        0;  ///< samples with weakly active edges, or an active set that changes within the tolerance
};

/// Runs a prior over a problem file and writes a projection file (contract), whole or not at all; memory does not grow
/// with the number of samples. What is written does not depend on `jobs` or on the neighbours of a sample. Throws
/// Error for what is wrong with the files.
ProjectSummary project(const ProjectConfig& config, const ProjectOptions& options);

}  // namespace toile::generate
