#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evaluate/stress_problem.h"
#include "prior/report.h"

namespace toile::evaluate {

/// The prior's own algorithm, or the paper's, for comparison: the cone program, and Newton's method on top of conjugate
/// gradients.
enum class StressRoute { own, paper };

/// The method's name, as `toile project --set method=` takes it.
std::string_view method_name(PriorKind prior, StressRoute route);

/// What came of one sample of a problem. Residuals are computed again from the positions, not taken from the report.
struct StressOutcome {
    int problem = 0;
    int sample = 0;
    PriorKind prior = PriorKind::inextensibility;
    StressRoute route = StressRoute::own;
    PredictionKind kind = PredictionKind::noise;
    int vertices = 0;
    prior::Status status = prior::Status::rejected_input;
    bool finite = false;  ///< every position
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

    bool met() const {
        return failure.empty() && finite && status == prior::Status::converged && residual <= tolerance;
    }
    /// Says converged and is not.
    bool false_claim() const { return status == prior::Status::converged && !(residual <= tolerance); }
    bool derivative_met() const { return !derivative_checked || (derivative_claimed && identity_error <= 1e-9); }
    bool false_derivative() const { return derivative_checked && derivative_claimed && !(identity_error <= 1e-9); }
};

/// What a problem was solved to, for who wants to keep it.
struct StressSolution {
    std::vector<double> position;       ///< `[N x V x 3]` r*; empty where the prior threw
    std::vector<double> loss_gradient;  ///< `[N x V x 3]` that its derivative was probed with; empty where it was not
};

/// Solves one problem: one outcome for each of its samples. Never throws: what a prior throws is a failure.
std::vector<StressOutcome> solve_problem(const StressProblem& problem, StressRoute route, StressSolution& solution);
std::vector<StressOutcome> solve_problem(const StressProblem& problem, StressRoute route = StressRoute::own);

}  // namespace toile::evaluate
