#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "cloth/squeeze.h"
#include "tests/cloth/one_triangle.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

using test::columns;
using test::deformed_by;
using test::flat;
using test::one_triangle;

const MembraneStiffness woven = MembraneStiffness::from_moduli(300.0, 500.0, 120.0, 0.3);

/// F with stretches `first` and `second` along a pattern direction at `angle` and across it, turned in space.
Deformation stretched(double first, double second, double angle) {
    const Eigen::Matrix2d inner = Eigen::Rotation2Dd(angle).toRotationMatrix();
    const Eigen::Matrix3d outer = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -2, 2) / 3.0).toRotationMatrix();
    return outer.leftCols<2>() * Eigen::Vector2d(first, second).asDiagonal() * inner.transpose();
}

TrianglePositions squeezed(double first, double second, double angle) {
    const Deformation f = stretched(first, second, angle);
    return deformed_by(one_triangle(), f.col(0), f.col(1));
}

/// Force along the direction that is squeezed to `stretch`, per width [N/m]: dψ/dλ by the chain rule.
double force(const MembraneStiffness& stiffness, double stretch, double angle) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    const TriangleGradient gradient = membrane_gradient(stencil, stiffness, squeezed(stretch, 1.0, angle));
    const Eigen::VectorXd motion = flat(squeezed(1.0, 1.0, angle)) - flat(squeezed(0.0, 1.0, angle));
    return gradient.dot(motion) / stencil.area;
}

TEST(Squeeze, ActsBelowItsOnsetAlone) {
    EXPECT_FALSE(Squeeze::acts(stretched(1.2, 0.701, 0.4)));
    EXPECT_TRUE(Squeeze::acts(stretched(1.2, 0.699, 0.4)));
    EXPECT_TRUE(Squeeze::acts(stretched(0.3, 0.2, 0.4)));
    EXPECT_TRUE(Squeeze::acts(stretched(1.0, 0.0, 0.4)));
    EXPECT_FALSE(Squeeze::acts(stretched(5.0, 5.0, 0.0)));
    EXPECT_EQ(Squeeze(stretched(1.2, 0.71, 0.4), 100.0).energy(), 0.0);
}

TEST(Squeeze, TheForceNeverFallsOnTheWayDown) {
    const MembraneStiffness even = MembraneStiffness::from_moduli(1000, 1000, 300, 0.3);
    for (const MembraneStiffness& stiffness : {woven, even})
        for (const double angle : {0.0, 0.4, 0.7854, 1.5708})
            for (double stretch = 0.98; stretch > 0.015; stretch -= 0.01)
                EXPECT_LT(force(stiffness, stretch - 0.01, angle), force(stiffness, stretch, angle))
                    << stretch << " at " << angle;
}

TEST(Squeeze, GradientAndHessianAreDerivatives) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const auto& [first, second] : {std::pair{1.1, 0.5}, {0.5, 0.3}, {1.0, 0.05}, {0.4, 0.4 + 1e-4}, {2.0, 0.69}}) {
        const TrianglePositions x = squeezed(first, second, 0.6);
        const auto energy = [&](const Eigen::VectorXd& at) { return membrane_energy(stencil, woven, columns(at)); };
        auto check = test::check_gradient(energy, membrane_gradient(stencil, woven, x), flat(x), 0.03, 1e-6);
        EXPECT_TRUE(check.passed) << first << " " << second << " " << check.message;
        const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            return membrane_gradient(stencil, woven, columns(at));
        };
        check = test::check_jacobian(gradient, membrane_hessian(stencil, woven, x), flat(x), 0.03, 1e-6);
        EXPECT_TRUE(check.passed) << first << " " << second << " " << check.message;
    }
}

TEST(Squeeze, ProjectedHessianIsSemidefiniteAndFinite) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const auto& [first, second] : {std::pair{1.1, 0.5}, {0.5, 0.3}, {1.0, 1e-9}, {0.0, 0.0}, {0.5, 0.5}}) {
        const TriangleHessian hessian = membrane_projected_hessian(stencil, woven, squeezed(first, second, 0.6));
        ASSERT_TRUE(hessian.allFinite());
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<TriangleHessian>(hessian).eigenvalues();
        EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff()) << first << " " << second;
    }
}

TEST(Squeeze, ACollapsedTriangleIsPushedOpen) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const auto& [first, second] : {std::pair{1.0, 0.0}, {0.9, 1e-12}, {0.0, 0.0}}) {
        const TrianglePositions x = squeezed(first, second, 0.6);
        const TriangleGradient gradient = membrane_gradient(stencil, woven, x);
        ASSERT_TRUE(gradient.allFinite());
        EXPECT_GT(gradient.norm(), 0.01);
        const TrianglePositions moved = columns(flat(x) - 1e-4 * gradient);
        EXPECT_LT(membrane_energy(stencil, woven, moved), membrane_energy(stencil, woven, x));
        EXPECT_GT((moved.col(1) - moved.col(0)).cross(moved.col(2) - moved.col(0)).norm(),
                  (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm());
    }
}

}  // namespace
}  // namespace toile
