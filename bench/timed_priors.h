#pragma once

#include <span>

#include "bench/timed_prior.h"
#include "prior/inextensibility.h"

namespace toile::bench {

/// What `TimedPrior` needs to know of the inextensibility prior: no stretch allowed.
struct TimedInextensibility {
    using Prior = prior::Inextensibility;
    using Options = prior::InextensibilityOptions;
    using Solution = prior::InextensibilitySolution;
    using Gradient = prior::InextensibilityGradient;
    static constexpr const char* name = "inextensibility";

    static prior::InextensibilityModel model(const prior::RestState& rest) {
        return prior::InextensibilityModel::from(rest, 0.0);
    }
    static void backward(const Prior& prior, std::span<const double>, const Solution& solution,
                         std::span<const double> loss_gradient, Gradient& gradient, Prior::Workspace& workspace) {
        prior.backward(solution, loss_gradient, gradient, workspace);
    }
    static double residual(const Prior& prior, std::span<const double> predicted, const Solution& solution,
                           int sample) {
        const std::size_t positions = predicted.size(), edges = prior.model().edge.rows();
        return prior::inextensibility_residual(
            prior.model(), predicted, std::span<const double>(solution.position).subspan(sample * positions, positions),
            std::span<const double>(solution.multiplier).subspan(sample * edges, edges));
    }
};

}  // namespace toile::bench
