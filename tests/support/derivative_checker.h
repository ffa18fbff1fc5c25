#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace toile::test {

/// What a comparison with finite differences found.
struct DerivativeCheck {
    bool passed = false;
    double error =
        0;            ///< smallest over the sweep of the largest difference, relative to the derivative's largest entry
    double step = 0;  ///< where it was smallest
    std::string message;
};

/// Compares `jacobian` `[m x n]` at `x` with central differences of `function` (`[n]` to `[m]`).
///
/// Steps sweep from 1e-2 to 1e-8 times `scale` (the size of x that matters) by factors of ten; too long a step sees
/// curvature, too short a one sees rounding, and the best of them counts. Passes if
///
///     max |J − J_fd| <= tolerance · max(|J|, |J_fd|)
///
/// for one step of the sweep. A derivative that is zero everywhere fails: it shows nothing.
DerivativeCheck check_jacobian(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function,
                               const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& x, double scale,
                               double tolerance = 1e-7);

/// The same for a scalar function and its gradient `[n]`.
DerivativeCheck check_gradient(const std::function<double(const Eigen::VectorXd&)>& function,
                               const Eigen::VectorXd& gradient, const Eigen::VectorXd& x, double scale,
                               double tolerance = 1e-7);

}  // namespace toile::test
