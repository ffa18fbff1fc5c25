#pragma once

#include <span>

#include "bench/timed_prior.h"
#include "prior/inextensibility.h"
#include "prior/quasistatic.h"

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

/// The quasistatic prior with its default fabric and μ = 0.1.
struct TimedQuasistatic {
    using Prior = prior::Quasistatic;
    using Options = prior::QuasistaticOptions;
    using Solution = prior::QuasistaticSolution;
    using Gradient = prior::QuasistaticGradient;
    static constexpr const char* name = "quasistatic";

    static prior::QuasistaticModel model(const prior::RestState& rest) { return prior::QuasistaticModel::from(rest); }
    static void backward(const Prior& prior, std::span<const double> predicted, const Solution& solution,
                         std::span<const double> loss_gradient, Gradient& gradient, Prior::Workspace& workspace) {
        prior.backward(predicted, solution, loss_gradient, gradient, workspace);
    }
    static double residual(const Prior& prior, std::span<const double> predicted, const Solution& solution,
                           int sample) {
        return prior::quasistatic_residual(
            prior.model(), predicted,
            std::span<const double>(solution.position).subspan(sample * predicted.size(), predicted.size()));
    }
};

}  // namespace toile::bench
