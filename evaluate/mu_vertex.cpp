#include "evaluate/mu_vertex.h"

#include <LBFGS.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cloth/error.h"
#include "evaluate/mu_objective.h"
#include "generate/ordered_work.h"

namespace toile::evaluate {
namespace {

constexpr double least_progress = 1e-3;  // of the objective, over two iterations: less has converged
constexpr double near_bound = 0.01;      // of the distance of the bounds, in log μ

LBFGSpp::LBFGSParam<double> optimiser_options(int iterations) {
    LBFGSpp::LBFGSParam<double> param;
    param.m = 10;
    param.epsilon = 1e-3;  // of the gradient at the start
    param.epsilon_rel = 0.0;
    param.past = 2;
    param.delta = least_progress;
    param.max_iterations = iterations;
    param.max_linesearch = 8;
    return param;
}

/// The objective with its gradient at the start scaled to 1, in variables that make the optimiser's first step, of
/// length 1, the Newton step of a problem with the Hessian 1: the variables are made for that.
class Scaled {
  public:
    Scaled(MuObjective& objective, const Eigen::VectorXd& start) : objective_(objective), start_(start) {
        value_ = objective_(start_, gradient_);
        scale_ = gradient_.norm();
    }
    double scale() const { return scale_; }

    double operator()(const Eigen::VectorXd& step, Eigen::VectorXd& gradient) {
        if (!step.isZero(0.0)) value_ = objective_(start_ + scale_ * step, gradient_);
        gradient = gradient_ / scale_;
        return value_ / (scale_ * scale_);
    }

  private:
    MuObjective& objective_;
    Eigen::VectorXd start_, gradient_;
    double value_ = 0, scale_ = 0;
};

/// Runs L-BFGS on the objective, which keeps what was best.
MuStatus minimise(MuObjective& objective, const Eigen::VectorXd& start, int iterations) {
    Scaled scaled(objective, start);
    if (scaled.scale() == 0.0) return MuStatus::converged;
    const LBFGSpp::LBFGSParam<double> param = optimiser_options(iterations);
    LBFGSpp::LBFGSSolver<double> solver(param);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(start.size());
    double value = 0.0;
    try {
        return solver.minimize(scaled, step, value) < iterations ? MuStatus::converged : MuStatus::iterations_used;
    } catch (const Error&) {
        throw;
    } catch (const generate::Interrupted&) {
        throw;
    } catch (const std::runtime_error&) {
        // No step of the line search brought the loss down: it is as low as its small jumps, where cloth buckles
        // another way, allow.
        return MuStatus::converged;
    }
}

/// Where more than half of the vertices have come to a bound, the bound is what came of it.
MuStatus status_at_bounds(const Eigen::VectorXd& log_mu, const MuFitOptions& options, MuStatus status) {
    const double low = std::log(options.low), high = std::log(options.high), margin = near_bound * (high - low);
    const Eigen::Index half = log_mu.size() / 2;
    if ((log_mu.array() > high - margin).count() > half) return MuStatus::at_upper_bound;
    if ((log_mu.array() < low + margin).count() > half) return MuStatus::at_lower_bound;
    return status;
}

double error_of(MuLoss& loss, const Eigen::VectorXd& log_mu) {
    return loss.sample_count() == 0 ? std::numeric_limits<double>::quiet_NaN()
                                    : std::sqrt(loss(log_mu, false).squared_error);
}

}  // namespace

MuVertexFit fit_vertex_mu(MuLoss& loss, MuLoss& chosen_by, const MuSmoothing& smoothing, const MuFitOptions& options,
                          double global_mu, double unit, const std::function<void()>& evaluated, int& left_out) {
    Eigen::VectorXd log_mu = Eigen::VectorXd::Constant(loss.vertex_count(), std::log(global_mu));
    MuVertexFit fit;
    fit.mu = log_mu.array().exp();
    fit.smoothness = std::numeric_limits<double>::infinity();
    fit.status = MuStatus::converged;
    double least = error_of(chosen_by, log_mu);
    for (const double weight : options.smoothness) {
        const MuVariables variables(smoothing, weight, options.low, options.high);
        MuObjective objective(loss, smoothing, variables, weight, unit, evaluated);
        const MuStatus status = minimise(objective, variables.of(log_mu), options.iterations);
        left_out = std::max(left_out, objective.left_out());
        log_mu = variables.log_mu(objective.best());
        const double error = error_of(chosen_by, log_mu);
        fit.tried.push_back({weight, std::sqrt(objective.best_squared_error()), error,
                             static_cast<int>(objective.history().size()), status});
        if (error >= least) break;
        least = error;
        fit.mu = log_mu.array().exp();
        fit.status = status_at_bounds(log_mu, options, status);
        fit.smoothness = weight;
        fit.history = objective.history();
        if (std::isnan(error)) break;
    }
    return fit;
}

}  // namespace toile::evaluate
