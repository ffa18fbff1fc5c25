#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "evaluate/derivative_identity.h"

namespace toile::evaluate {
namespace {

struct Products {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(6, 6);
    std::vector<double> loss_gradient, direction;
    Products() {
        Random random(1);
        loss_gradient = random_direction(6, random);
        direction = random_direction(6, random);
    }
    /// With the tangent of a Jacobian that is off by `defect`.
    double error(double defect) const {
        const Eigen::VectorXd g = Eigen::Map<const Eigen::VectorXd>(loss_gradient.data(), 6);
        const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(direction.data(), 6);
        const Eigen::VectorXd back = jacobian.transpose() * g;
        const Eigen::VectorXd forward = jacobian * v + defect * v;
        return identity_error(loss_gradient, {forward.data(), 6}, {back.data(), 6}, direction);
    }
};

TEST(DerivativeIdentity, HoldsForAMatrixAndItsTranspose) {
    EXPECT_LT(Products().error(0), 1e-15);
}

TEST(DerivativeIdentity, SeesASmallDefect) {
    EXPECT_GT(Products().error(1e-6), 1e-9);
}

TEST(DerivativeIdentity, IsZeroWhereBothProductsVanishAndNaNWhereOneIs) {
    const std::vector<double> zero(3, 0.0), one(3, 1.0), nan(3, std::nan(""));
    EXPECT_EQ(identity_error(one, zero, zero, one), 0.0);
    EXPECT_TRUE(std::isnan(identity_error(one, nan, one, one)));
}

TEST(DerivativeIdentity, ProbesAreHalfAlongTheGradient) {
    Random random(1);
    const std::vector<double> gradient = random_direction(60, random);
    const std::vector<double> probe = probe_direction(gradient, 2, random);
    for (int s = 0; s < 2; ++s) {
        const Eigen::Map<const Eigen::VectorXd> g(gradient.data() + 30 * s, 30), v(probe.data() + 30 * s, 30);
        EXPECT_GT(g.dot(v) / g.norm() / v.norm(), 0.5);
    }
}

}  // namespace
}  // namespace toile::evaluate
