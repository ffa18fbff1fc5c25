#include "tests/support/derivative_checker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace toile::test {

DerivativeCheck check_jacobian(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function,
                               const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& x, double scale,
                               double tolerance) {
    DerivativeCheck check;
    check.error = std::numeric_limits<double>::infinity();
    const Eigen::Index outputs = function(x).size();
    if (jacobian.rows() != outputs || jacobian.cols() != x.size()) {
        check.message = "the derivative has another shape than the function";
        return check;
    }
    if (!jacobian.allFinite()) {
        check.message = "the derivative is not finite";
        return check;
    }
    for (double step = 1e-2 * scale; step > 0.5e-8 * scale; step *= 0.1) {
        Eigen::MatrixXd difference(outputs, x.size());
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            Eigen::VectorXd forward = x, backward = x;
            forward[k] += step;
            backward[k] -= step;
            difference.col(k) = (function(forward) - function(backward)) / (forward[k] - backward[k]);
        }
        const double largest = std::max(jacobian.cwiseAbs().maxCoeff(), difference.cwiseAbs().maxCoeff());
        if (!(largest > 0.0)) continue;
        const double error = (jacobian - difference).cwiseAbs().maxCoeff() / largest;
        if (error < check.error) {
            check.error = error;
            check.step = step;
        }
    }
    const bool zero = jacobian.cwiseAbs().maxCoeff() == 0.0;
    check.passed = !zero && check.error <= tolerance;
    std::ostringstream text;
    text << (zero ? "the derivative is zero everywhere; " : "") << "relative error " << check.error << " at step "
         << check.step << ", tolerance " << tolerance;
    check.message = text.str();
    return check;
}

DerivativeCheck check_gradient(const std::function<double(const Eigen::VectorXd&)>& function,
                               const Eigen::VectorXd& gradient, const Eigen::VectorXd& x, double scale,
                               double tolerance) {
    return check_jacobian([&](const Eigen::VectorXd& at) { return Eigen::VectorXd::Constant(1, function(at)); },
                          gradient.transpose(), x, scale, tolerance);
}

}  // namespace toile::test
