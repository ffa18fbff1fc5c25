#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "cloth/strain_limit.h"
#include "tests/cloth/one_triangle.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

using test::columns;
using test::deformed_by;
using test::flat;
using test::one_triangle;

const StrainLimit limit{1.1, 1.05, 1e6};
const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);

/// Beyond along weft, along warp, along both; all of them sheared and turned.
std::vector<TrianglePositions> beyond() {
    const ClothMesh mesh = one_triangle();
    return {deformed_by(mesh, {1.0, 0.5, 0.2}, {0.1, 0.9, 0.3}), deformed_by(mesh, {0.3, 0.0, 0.1}, {-0.4, 1.05, 0.3}),
            deformed_by(mesh, {1.2, 0.2, 0.0}, {0.0, 1.1, 0.2})};
}

TEST(StrainLimit, NothingHappensWithinIt) {
    const TrianglePositions x = deformed_by(one_triangle(), {0.0, 1.099, 0.0}, {0.2, 0.0, 1.02});
    EXPECT_FALSE(strain_limit_acts(stencil, limit, x));
    EXPECT_EQ(strain_limit_energy(stencil, limit, x), 0.0);
    EXPECT_EQ(strain_limit_gradient(stencil, limit, x).norm(), 0.0);
    EXPECT_EQ(strain_limit_hessian(stencil, limit, x).norm(), 0.0);
}

TEST(StrainLimit, CarriesItsTensionOnePercentBeyond) {
    const StrainLimit carrying = StrainLimit::carrying(1.1, 1.2, 400.0);
    const TrianglePositions x = deformed_by(one_triangle(), {1.11, 0, 0}, {0, 1, 0});
    const TriangleGradient motion = flat(deformed_by(one_triangle(), {2.11, 0, 0}, {0, 1, 0})) - flat(x);
    EXPECT_NEAR(strain_limit_gradient(stencil, carrying, x).dot(motion) / stencil.area, 400.0, 1e-6);
}

TEST(StrainLimit, GradientAndHessianAreDerivatives) {
    for (const TrianglePositions& x : beyond()) {
        EXPECT_TRUE(strain_limit_acts(stencil, limit, x));
        const auto energy = [&](const Eigen::VectorXd& at) { return strain_limit_energy(stencil, limit, columns(at)); };
        auto check = test::check_gradient(energy, strain_limit_gradient(stencil, limit, x), flat(x), 0.03, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
        const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            return strain_limit_gradient(stencil, limit, columns(at));
        };
        const TriangleHessian hessian = strain_limit_hessian(stencil, limit, x);
        check = test::check_jacobian(gradient, hessian, flat(x), 0.03, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<TriangleHessian>(hessian).eigenvalues();
        EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
    }
}

}  // namespace
}  // namespace toile
