#include "evaluate/mu_objective.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace toile::evaluate {

MuObjective::MuObjective(MuLoss& loss, const MuSmoothing& smoothing, const MuVariables& variables, double weight,
                         double unit, std::function<void()> evaluated)
    : loss_(loss),
      smoothing_(smoothing),
      variables_(variables),
      weight_(weight),
      unit_(unit),
      evaluated_(std::move(evaluated)) {}

double MuObjective::operator()(const Eigen::VectorXd& z, Eigen::VectorXd& gradient) {
    if (evaluated_) evaluated_();
    const Eigen::VectorXd x = variables_.log_mu(z);
    const MuLoss::Value loss = loss_(x);
    const Eigen::VectorXd smoothing = weight_ * (smoothing_.laplacian() * x);
    const double value = loss.squared_error / unit_ + 0.5 * x.dot(smoothing);
    gradient = variables_.pull_back(loss.gradient / unit_ + smoothing, z);

    left_out_ = std::max(left_out_, loss.left_out);
    history_.push_back({std::exp(x.mean()), std::sqrt(loss.squared_error), value});
    if (best_.size() == 0 || value < best_objective_) {
        best_ = z;
        best_objective_ = value;
        best_squared_error_ = loss.squared_error;
    }
    return value;
}

}  // namespace toile::evaluate
