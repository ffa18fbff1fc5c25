#include "bench/stress.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <exception>

#include "bench/stress_inextensibility.h"
#include "bench/stress_quasistatic.h"
#include "cloth/parallel.h"

namespace toile::bench {
namespace {

double thread_seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::vector<StressOutcome> solve_problem(const StressProblem& problem) {
    std::vector<StressOutcome> outcome(problem.sample_count());
    for (int s = 0; s < problem.sample_count(); ++s) {
        outcome[s].problem = problem.number;
        outcome[s].sample = s;
        outcome[s].prior = problem.prior;
        outcome[s].kind = problem.kind[s];
        outcome[s].vertices = problem.mesh.vertex_count();
        outcome[s].tolerance = problem.tolerance;
        outcome[s].description = problem.description(s);
    }
    const double start = thread_seconds();
    try {
        if (problem.prior == PriorKind::inextensibility)
            solve_inextensibility(problem, outcome);
        else
            solve_quasistatic(problem, outcome);
    } catch (const std::exception& error) {
        for (StressOutcome& each : outcome) each.failure = error.what();
    }
    const double seconds = thread_seconds() - start;
    for (StressOutcome& each : outcome) each.seconds = seconds / problem.sample_count();
    return outcome;
}

std::vector<StressOutcome> run_stress(const StressDraw& draw, int first, int count, int jobs,
                                      const std::function<void(int)>& progress) {
    std::vector<std::vector<StressOutcome>> by_problem(count);
    std::atomic<int> done = 0;
    parallel_for(count, jobs, [&](int, int index) {
        by_problem[index] = solve_problem(draw_problem(draw, first + index));
        const int now = ++done;
        if (progress && now % 100 == 0) progress(now);
    });
    std::vector<StressOutcome> outcome;
    for (auto& part : by_problem) std::move(part.begin(), part.end(), std::back_inserter(outcome));
    return outcome;
}

}  // namespace toile::bench
