#pragma once

#include <span>

#include "prior/inextensibility_buffers.h"

namespace toile::prior {

/// Where a group's time went, in seconds of all its lanes together.
struct StageSeconds {
    double sweep = 0, assembly = 0, factor = 0, solve = 0;
};

/// How `project_samples` goes about it.
struct InteriorPointStart {
    int sweeps = 40;             ///< first-order sweeps before the interior point
    double least_centre = 1e-5;  ///< smallest μ to start from, relative to the largest multiplier
};

/// One sample on its way: what goes in, where results go, what came of it.
struct InextensibilityTask {
    const double* predicted = nullptr;  ///< `[V x 3]`
    double* position = nullptr;         ///< `[V x 3]` out; with `warm` also in
    double* multiplier = nullptr;       ///< `[E]` out; with `warm` also in
    bool warm = false;
    Report report{};  ///< status, iterations and sweeps; the residual is for the caller to find from what was written
};

/// Primal-dual interior point (Mehrotra's predictor and corrector, with one of Gondzio's centrality corrections),
/// started by a few sweeps of the alternating direction method of multipliers on the constant matrix. W samples go side
/// by side, each with its own μ and step length. One that has arrived makes room for the next, which `waiting` holds
/// prepared: eight samples are swept at a time, and no lane waits for the slowest. What a sample becomes does not
/// depend on its neighbours.
template <int W>
void project_samples(InextensibilityBuffers<W>& solving, InextensibilityBuffers<W>& waiting,
                     std::span<InextensibilityTask> task, const InextensibilityOptions& options,
                     const InteriorPointStart& start, StageSeconds& seconds);

}  // namespace toile::prior
