#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/derivative_checker.h"

namespace toile::test {
namespace {

double value(const Eigen::VectorXd& x) {
    return std::sin(x[0]) * x[1] * x[1] + std::exp(0.3 * x[1]) * x[2];
}
Eigen::VectorXd gradient(const Eigen::VectorXd& x) {
    return Eigen::Vector3d(std::cos(x[0]) * x[1] * x[1],
                           2.0 * std::sin(x[0]) * x[1] + 0.3 * std::exp(0.3 * x[1]) * x[2], std::exp(0.3 * x[1]));
}
const Eigen::VectorXd at = Eigen::Vector3d(0.7, -1.3, 2.1);

TEST(DerivativeChecker, PassesATrueGradient) {
    const DerivativeCheck check = check_gradient(value, gradient(at), at, 1.0, 1e-8);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(DerivativeChecker, FailsOneWrongEntryInEach) {
    for (int k = 0; k < 3; ++k) {
        Eigen::VectorXd wrong = gradient(at);
        wrong[k] *= 1.0 + 1e-4;
        EXPECT_FALSE(check_gradient(value, wrong, at, 1.0, 1e-7).passed) << "entry " << k;
    }
}

TEST(DerivativeChecker, FailsASwappedSign) {
    EXPECT_FALSE(check_gradient(value, -gradient(at), at, 1.0).passed);
}

TEST(DerivativeChecker, FailsADerivativeThatIsZero) {
    const auto constant = [](const Eigen::VectorXd&) { return 1.0; };
    EXPECT_FALSE(check_gradient(constant, Eigen::Vector3d::Zero(), at, 1.0).passed);
}

TEST(DerivativeChecker, FailsATransposedJacobian) {
    const auto function = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return Eigen::Vector3d(x[0] * x[1], x[1] * x[2], x[2]);
    };
    Eigen::Matrix3d jacobian;
    jacobian << at[1], at[0], 0, 0, at[2], at[1], 0, 0, 1;
    EXPECT_TRUE(check_jacobian(function, jacobian, at, 1.0).passed);
    EXPECT_FALSE(check_jacobian(function, jacobian.transpose(), at, 1.0).passed);
}

TEST(DerivativeChecker, FailsAJacobianOfAnotherShape) {
    EXPECT_FALSE(check_gradient(value, Eigen::Vector2d(1, 1), at, 1.0).passed);
}

TEST(DerivativeChecker, FailsNaN) {
    Eigen::VectorXd wrong = gradient(at);
    wrong[1] = NAN;
    EXPECT_FALSE(check_gradient(value, wrong, at, 1.0).passed);
}

}  // namespace
}  // namespace toile::test
