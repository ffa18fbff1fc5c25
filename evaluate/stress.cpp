#include "evaluate/stress.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>

#include "evaluate/stress_inextensibility.h"
#include "evaluate/stress_quasistatic.h"

namespace toile::evaluate {
namespace {

double thread_seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::string_view method_name(PriorKind prior, StressRoute route) {
    if (prior == PriorKind::inextensibility) return route == StressRoute::own ? "interior_point" : "cone";
    return route == StressRoute::own ? "fast" : "newton_cg";
}

std::vector<StressOutcome> solve_problem(const StressProblem& problem, StressRoute route, StressSolution& solution) {
    std::vector<StressOutcome> outcome(problem.sample_count());
    for (int s = 0; s < problem.sample_count(); ++s) {
        outcome[s].problem = problem.number;
        outcome[s].sample = s;
        outcome[s].prior = problem.prior;
        outcome[s].route = route;
        outcome[s].kind = problem.kind[s];
        outcome[s].vertices = problem.mesh.vertex_count();
        outcome[s].tolerance = problem.tolerance;
        outcome[s].description = problem.description(s);
    }
    const double start = thread_seconds();
    try {
        if (problem.prior == PriorKind::inextensibility)
            solve_inextensibility(problem, route, outcome, solution);
        else
            solve_quasistatic(problem, route, outcome, solution);
    } catch (const std::exception& error) {
        for (StressOutcome& each : outcome) each.failure = error.what();
    }
    const double seconds = thread_seconds() - start;
    const std::size_t each = problem.predicted.size() / problem.sample_count();
    for (int s = 0; s < problem.sample_count(); ++s) {
        outcome[s].seconds = seconds / problem.sample_count();
        const auto part = std::span<const double>(solution.position).subspan(solution.position.empty() ? 0 : s * each);
        outcome[s].finite = part.size() >= each &&
                            std::all_of(part.begin(), part.begin() + each, [](double x) { return std::isfinite(x); });
    }
    return outcome;
}

std::vector<StressOutcome> solve_problem(const StressProblem& problem, StressRoute route) {
    StressSolution solution;
    return solve_problem(problem, route, solution);
}

}  // namespace toile::evaluate
