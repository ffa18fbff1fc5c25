#include "evaluate/stability_priors.h"

#include <algorithm>
#include <limits>
#include <string>

#include "evaluate/stability_replay.h"

namespace toile::evaluate {
namespace {

constexpr int quick_problems = 40, quick_vertices = 300;
constexpr int most_vertices_of_papers_route = 2000;

std::string status_of(const StressOutcome& one) {
    if (!one.failure.empty()) return "failed: " + one.failure;
    if (one.false_claim()) return "false claim of convergence";
    if (one.status == prior::Status::rejected_input) return "rejected input";
    if (one.status == prior::Status::accuracy_not_reached) return "accuracy not reached";
    if (one.false_derivative()) return "false claim of the derivative";
    return one.derivative_met() ? "converged" : "derivative not accurate";
}

StabilityOutcome outcome_of(const StressOutcome& found, std::string name, const std::string& solver) {
    StabilityOutcome one;
    one.group = evaluate::name(found.kind);
    one.name = std::move(name);
    one.solver = solver;
    one.status = status_of(found);
    one.finite = found.finite;
    one.iterations = found.iterations;
    one.vertices = found.vertices;
    one.certificate.seconds = found.seconds;
    one.prior = found;
    return one;
}

}  // namespace

const std::vector<std::string>& prior_names() {
    static const std::vector<std::string> names{std::string(name(PriorKind::inextensibility)),
                                                std::string(name(PriorKind::quasistatic))};
    return names;
}

std::string prior_solver(const std::string& prior, StressRoute route) {
    const PriorKind kind = prior == name(PriorKind::quasistatic) ? PriorKind::quasistatic : PriorKind::inextensibility;
    return prior + "/" + std::string(method_name(kind, route));
}

std::string prior_case_name(const StressProblem& problem, const StressDraw& draw, int sample) {
    return "problem " + std::to_string(problem.number) + " of seed " + std::to_string(draw.seed) + ", sample " +
           std::to_string(sample) + ": " + std::string(name(problem.kind[sample])) + ", " +
           std::string(name(problem.mesh_kind)) + " of " + std::to_string(problem.mesh.vertex_count()) + " vertices";
}

std::vector<int> chosen_problems(const PriorSuite& suite, PriorKind prior, StressRoute route, bool quick,
                                 const std::string& filter) {
    std::vector<int> chosen;
    for (int number = 0; number < (quick ? std::min(quick_problems, suite.problems) : suite.problems); ++number) {
        const StressProblem problem = draw_problem(suite.draw, number);
        const int vertices = problem.mesh.vertex_count();
        if (problem.prior != prior || (quick && vertices > quick_vertices)) continue;
        if (route == StressRoute::paper && vertices > most_vertices_of_papers_route) continue;
        bool any = false;
        for (int s = 0; s < problem.sample_count() && !any; ++s)
            any = prior_case_name(problem, suite.draw, s).find(filter) != std::string::npos;
        if (any) chosen.push_back(number);
    }
    return chosen;
}

std::vector<StabilityOutcome> run_prior_problem(const PriorSuite& suite, int number, StressRoute route,
                                                const std::function<bool(const std::string&)>& wanted,
                                                const std::string& folder) {
    const StressProblem problem = draw_problem(suite.draw, number);
    std::vector<int> samples;
    for (int s = 0; s < problem.sample_count(); ++s)
        if (wanted(prior_case_name(problem, suite.draw, s))) samples.push_back(s);
    std::vector<StabilityOutcome> outcomes;
    if (samples.empty()) return outcomes;

    StressSolution solution;
    const std::vector<StressOutcome> found = solve_problem(problem, route, solution);
    const std::string solver = prior_solver(std::string(name(problem.prior)), route);
    for (const int s : samples)
        outcomes.push_back(outcome_of(found[s], prior_case_name(problem, suite.draw, s), solver));
    if (!folder.empty()) keep_problem(folder, problem, suite.draw, route, solution, outcomes);
    return outcomes;
}

}  // namespace toile::evaluate
