#include "evaluate/stress_quasistatic.h"

#include <algorithm>
#include <utility>

#include "evaluate/derivative_identity.h"
#include "prior/quasistatic.h"

namespace toile::evaluate {
namespace {

using prior::Quasistatic;

prior::QuasistaticModel model_of(const StressProblem& problem) {
    prior::QuasistaticStiffness stiffness;
    stiffness.stretch *= problem.stretch;
    stiffness.bending *= problem.bending;
    stiffness.axial *= problem.axial;
    return prior::QuasistaticModel::from(prior::rest_state(problem.mesh), stiffness, problem.mu);
}

/// The derivatives of one sample by everything the prior has derivatives in, as one vector: r̂, μ_i, three moduli.
std::vector<double> join(const std::vector<double>& predicted, const std::vector<double>& mu_vertex,
                         const std::vector<double>& stretch, const std::vector<double>& bending,
                         const std::vector<double>& axial, int sample, std::size_t vertices) {
    std::vector<double> all;
    all.insert(all.end(), predicted.begin() + sample * 3 * vertices, predicted.begin() + (sample + 1) * 3 * vertices);
    all.insert(all.end(), mu_vertex.begin() + sample * vertices, mu_vertex.begin() + (sample + 1) * vertices);
    for (const auto* modulus : {&stretch, &bending, &axial}) all.push_back((*modulus)[sample]);
    return all;
}

void check_derivative(const StressProblem& problem, const Quasistatic& solver,
                      const prior::QuasistaticSolution& solution, Quasistatic::Workspace& workspace,
                      std::span<StressOutcome> outcome, std::vector<double>& loss_gradient) {
    Random random(problem.derivative_seed);
    const int samples = problem.sample_count();
    const std::size_t vertices = problem.predicted.size() / samples / 3;
    loss_gradient = random_direction(problem.predicted.size(), random);
    prior::QuasistaticGradient gradient;
    solver.backward(problem.predicted, solution, loss_gradient, gradient, workspace);

    const std::vector<double> predicted = probe_direction(gradient.predicted, samples, random),
                              mu = probe_direction(gradient.mu_vertex, samples, random),
                              stretch = probe_direction(gradient.stretch, samples, random),
                              bending = probe_direction(gradient.bending, samples, random),
                              axial = probe_direction(gradient.axial, samples, random);
    prior::QuasistaticTangent tangent;
    solver.tangent(problem.predicted, solution, {predicted, mu, stretch, bending, axial}, tangent, workspace);
    for (int s = 0; s < samples; ++s) {
        const auto part = [&](const std::vector<double>& all) {
            return std::span<const double>(all).subspan(s * 3 * vertices, 3 * vertices);
        };
        outcome[s].derivative_checked = true;
        outcome[s].linear_residual = std::max(gradient.report[s].linear_residual, tangent.report[s].linear_residual);
        outcome[s].derivative_claimed = gradient.report[s].status == prior::Status::converged &&
                                        tangent.report[s].status == prior::Status::converged;
        outcome[s].positive_definite = gradient.report[s].positive_definite && tangent.report[s].positive_definite;
        outcome[s].identity_error = identity_error(part(loss_gradient), part(tangent.position),
                                                   join(gradient.predicted, gradient.mu_vertex, gradient.stretch,
                                                        gradient.bending, gradient.axial, s, vertices),
                                                   join(predicted, mu, stretch, bending, axial, s, vertices));
    }
}

}  // namespace

void solve_quasistatic(const StressProblem& problem, StressRoute route, std::span<StressOutcome> outcome,
                       StressSolution& kept) {
    prior::QuasistaticOptions options;
    options.tolerance = problem.tolerance;
    if (route == StressRoute::paper) options.method = prior::QuasistaticOptions::Method::newton_cg;
    Quasistatic solver(model_of(problem), options);
    if (problem.mu_varies) solver.set_mu(problem.mu_of_vertices());
    Quasistatic::Workspace workspace(solver);
    prior::QuasistaticSolution solution;
    solver.project(problem.predicted, solution, workspace);

    const std::size_t positions = problem.predicted.size() / problem.sample_count();
    for (int s = 0; s < problem.sample_count(); ++s) {
        outcome[s].status = solution.report[s].status;
        outcome[s].iterations = solution.report[s].iterations;
        outcome[s].residual =
            prior::quasistatic_residual(solver.model(), std::span(problem.predicted).subspan(s * positions, positions),
                                        std::span<const double>(solution.position).subspan(s * positions, positions));
    }
    if (problem.check_derivative) check_derivative(problem, solver, solution, workspace, outcome, kept.loss_gradient);
    kept.position = std::move(solution.position);
}

}  // namespace toile::evaluate
