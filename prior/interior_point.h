#pragma once

#include <array>

#include "prior/inextensibility_buffers.h"

namespace toile::prior {

/// Where a group's time went, in seconds of all its lanes together.
struct StageSeconds {
    double sweep = 0, assembly = 0, factor = 0, solve = 0;
};

/// How `project_group` goes about it.
struct InteriorPointStart {
    int sweeps = 40;             ///< first-order sweeps before the interior point
    double least_centre = 1e-5;  ///< smallest μ to start from, relative to the largest multiplier
};

/// One sample of a group: what goes in, where results go, what came of it.
struct InextensibilityLane {
    const double* predicted = nullptr;  ///< `[V x 3]`; null: the lane is not used
    double* position = nullptr;         ///< `[V x 3]` out; with `warm` also in
    double* multiplier = nullptr;       ///< `[E]` out; with `warm` also in
    bool warm = false;
    Report
        report{};  ///< status, iterations and sweeps; the residual is for the caller to find out from what was written
};

/// Primal-dual interior point (Mehrotra's predictor and corrector, with one of Gondzio's centrality corrections) for W
/// samples side by side, started by a few sweeps of the alternating direction method of multipliers on the constant
/// matrix. Each lane has its own μ and step length and stops for itself.
template <int W>
void project_group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityLane, W>& lane,
                   const InextensibilityOptions& options, const InteriorPointStart& start, StageSeconds& seconds);

}  // namespace toile::prior
