#pragma once

#include <Eigen/Core>
#include <vector>

#include "evaluate/mu_fit.h"
#include "evaluate/mu_loss.h"
#include "evaluate/mu_smoothing.h"

namespace toile::evaluate {

/// What the fit of μ per vertex minimises, by the variables z of `MuVariables`:
///
///     loss(x) / unit + ½ w Σ_e c_e (x_a − x_b)²,   x = log μ(z)
///
/// It keeps its history and the best z seen, whatever the optimiser does.
class MuObjective {
  public:
    /// `unit`: a squared error [m²], above 0. `evaluated` is called before each evaluation; it may throw.
    MuObjective(MuLoss& loss, const MuSmoothing& smoothing, const MuVariables& variables, double weight, double unit,
                std::function<void()> evaluated = {});

    /// The value, and ∂/∂z in `gradient` `[V]`.
    double operator()(const Eigen::VectorXd& z, Eigen::VectorXd& gradient);

    const std::vector<MuStep>& history() const { return history_; }
    const Eigen::VectorXd& best() const { return best_; }  ///< z; empty before the first evaluation
    double best_objective() const { return best_objective_; }
    double best_squared_error() const { return best_squared_error_; }  ///< [m²]
    int left_out() const { return left_out_; }                         ///< most samples that an evaluation left out

  private:
    MuLoss& loss_;
    const MuSmoothing& smoothing_;
    const MuVariables& variables_;
    double weight_, unit_;
    std::function<void()> evaluated_;
    std::vector<MuStep> history_;
    Eigen::VectorXd best_;
    double best_objective_ = 0, best_squared_error_ = 0;
    int left_out_ = 0;
};

}  // namespace toile::evaluate
