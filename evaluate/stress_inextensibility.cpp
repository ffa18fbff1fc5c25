#include "evaluate/stress_inextensibility.h"

#include <algorithm>
#include <utility>

#include "evaluate/derivative_identity.h"
#include "prior/inextensibility.h"

namespace toile::evaluate {
namespace {

using prior::Inextensibility;

void check_derivative(const StressProblem& problem, const Inextensibility& solver,
                      const prior::InextensibilitySolution& solution, Inextensibility::Workspace& workspace,
                      std::span<StressOutcome> outcome, std::vector<double>& loss_gradient) {
    Random random(problem.derivative_seed);
    const int samples = problem.sample_count();
    loss_gradient = random_direction(problem.predicted.size(), random);
    prior::InextensibilityGradient gradient;
    solver.backward(solution, loss_gradient, gradient, workspace);
    const std::vector<double> direction = probe_direction(gradient.predicted, samples, random);
    prior::InextensibilityTangent tangent;
    solver.tangent(solution, direction, {}, tangent, workspace);
    const std::size_t each = problem.predicted.size() / samples;
    const auto part = [each](const std::vector<double>& all, int sample) {
        return std::span<const double>(all).subspan(sample * each, each);
    };
    for (int s = 0; s < samples; ++s) {
        outcome[s].derivative_checked = true;
        outcome[s].linear_residual = std::max(gradient.report[s].linear_residual, tangent.report[s].linear_residual);
        outcome[s].derivative_claimed = gradient.report[s].status == prior::Status::converged &&
                                        tangent.report[s].status == prior::Status::converged;
        outcome[s].identity_error = identity_error(part(loss_gradient, s), part(tangent.position, s),
                                                   part(gradient.predicted, s), part(direction, s));
    }
}

}  // namespace

void solve_inextensibility(const StressProblem& problem, StressRoute route, std::span<StressOutcome> outcome,
                           StressSolution& kept) {
    prior::InextensibilityOptions options;
    options.tolerance = problem.tolerance;
    if (route == StressRoute::paper) options.method = prior::InextensibilityOptions::Method::cone;
    const Inextensibility solver(
        prior::InextensibilityModel::from(prior::rest_state(problem.mesh), problem.stretch_limit), options);
    Inextensibility::Workspace workspace(solver);
    prior::InextensibilitySolution solution;
    solver.project(problem.predicted, solution, workspace);

    const std::size_t positions = problem.predicted.size() / problem.sample_count();
    const std::size_t edges = static_cast<std::size_t>(solver.model().edge.rows());
    for (int s = 0; s < problem.sample_count(); ++s) {
        outcome[s].status = solution.report[s].status;
        outcome[s].iterations = solution.report[s].iterations;
        outcome[s].residual = prior::inextensibility_residual(
            solver.model(), std::span(problem.predicted).subspan(s * positions, positions),
            std::span<const double>(solution.position).subspan(s * positions, positions),
            std::span<const double>(solution.multiplier).subspan(s * edges, edges));
    }
    if (problem.check_derivative) check_derivative(problem, solver, solution, workspace, outcome, kept.loss_gradient);
    kept.position = std::move(solution.position);
}

}  // namespace toile::evaluate
