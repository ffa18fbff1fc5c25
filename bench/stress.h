#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/stress_problem.h"
#include "prior/report.h"

namespace toile::bench {

/// What came of one sample of a problem. Residuals are computed again from the positions, not taken from the report.
struct StressOutcome {
    int problem = 0;
    int sample = 0;
    PriorKind prior = PriorKind::inextensibility;
    PredictionKind kind = PredictionKind::noise;
    int vertices = 0;
    prior::Status status = prior::Status::rejected_input;
    double tolerance = 0;
    double residual = 0;
    int iterations = 0;
    double seconds = 0;  ///< its share of the problem's processor time
    bool derivative_checked = false;
    double linear_residual =
        0;                      ///< of both products, the larger, as reported: the linear system is not visible outside
    double identity_error = 0;  ///< |<g, J v> - <Jᵀ g, v>| relative to |Jᵀ g| |v|
    bool derivative_claimed = false;  ///< both products say that they reached their accuracy
    bool positive_definite = true;    ///< quasistatic: false where the solution has no derivative, as reported
    std::string failure;              ///< an exception's message
    std::string description;

    bool met() const { return failure.empty() && status == prior::Status::converged && residual <= tolerance; }
    /// Says converged and is not.
    bool false_claim() const { return status == prior::Status::converged && !(residual <= tolerance); }
    bool derivative_met() const { return !derivative_checked || (derivative_claimed && identity_error <= 1e-9); }
    bool false_derivative() const { return derivative_checked && derivative_claimed && !(identity_error <= 1e-9); }
};

/// Solves one problem: one outcome for each of its samples. Never throws: what a prior throws is a failure.
std::vector<StressOutcome> solve_problem(const StressProblem& problem);

/// Problems `first` to `first + count - 1`, `jobs` at a time; outcomes in order. They do not depend on `jobs`, but for
/// seconds. `progress` is called now and then with the number of problems done, from any thread.
std::vector<StressOutcome> run_stress(const StressDraw& draw, int first, int count, int jobs,
                                      const std::function<void(int)>& progress = {});

}  // namespace toile::bench
