#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "cloth/fold.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

const Eigen::Vector4i hinge(0, 1, 2, 3);
constexpr double stiffness = 2e-5;

/// The pattern's shape, in the plane z = 0.
HingePositions unfolded() {
    HingePositions x;
    x << 0, 0.005, -0.017, 0.02, 0, 0.02, 0.008, 0.013, 0, 0, 0, 0;
    return x;
}

/// Two triangles that share an edge, with the starting shape `start`.
ClothMesh two_triangles(const HingePositions& start) {
    ClothMesh mesh;
    mesh.triangle.resize(2, 3);
    mesh.triangle << 0, 1, 2, 1, 0, 3;
    mesh.pattern_triangle = mesh.triangle;
    mesh.pattern_position = unfolded().topRows<2>().transpose();
    mesh.rest_position = start.transpose();
    return mesh;
}

/// The flat hinge with the second wing turned about the shared edge: all lengths are kept.
HingePositions turned(double angle) {
    HingePositions x = unfolded();
    const Eigen::Vector3d axis = (x.col(1) - x.col(0)).normalized(), arm = x.col(3) - x.col(0);
    x.col(3) = x.col(0) + std::cos(angle) * arm + std::sin(angle) * axis.cross(arm) +
               (1.0 - std::cos(angle)) * axis.dot(arm) * axis;
    return x;
}

/// All vertices off any symmetry.
HingePositions crooked(double angle) {
    HingePositions x = turned(angle);
    for (int k = 0; k < 12; ++k) x.data()[k] += 0.001 * std::sin(3.0 * k + 1.0);
    return x;
}

Eigen::VectorXd flat(const HingePositions& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), 12);
}
HingePositions columns(const Eigen::VectorXd& x) {
    return Eigen::Map<const HingePositions>(x.data());
}

TEST(Fold, KnowsAnglesUpToHalfATurn) {
    const double sign = fold_angle(turned(0.5)) > 0.0 ? 1.0 : -1.0;
    for (const double angle : {-3.1, -2.0, -0.3, 0.0, 1e-6, 0.7, 1.5708, 3.1})
        EXPECT_NEAR(fold_angle(turned(angle)), sign * angle, 1e-12);
}

TEST(Fold, ItsStartCostsNothing) {
    for (const double angle : {-2.5, 0.0, 0.8, 3.0}) {
        const FoldStencil stencil = fold_stencil(two_triangles(crooked(angle)), hinge, 0, 1);
        EXPECT_NEAR(fold_energy(stencil, stiffness, crooked(angle)), 0.0, 1e-25);
        EXPECT_LT(fold_gradient(stencil, stiffness, crooked(angle)).norm(), 1e-15);
        EXPECT_GT(fold_energy(stencil, stiffness, crooked(angle + 0.3)), 1e-8);
    }
}

TEST(Fold, FlatRestIsTheQuadraticFormAsLongAsLengthsAreKept) {
    const ClothMesh mesh = two_triangles(unfolded());
    const FoldStencil stencil = fold_stencil(mesh, hinge, 0, 1);
    const BendingStencil quadratic = bending_stencil(mesh, hinge, 0, 1);
    for (const double angle : {-3.0, -0.01, 0.1, 1.0, 2.0, 3.14159}) {
        const double expected = bending_energy(quadratic, stiffness, turned(angle));
        EXPECT_NEAR(fold_energy(stencil, stiffness, turned(angle)) / expected, 1.0, 1e-9) << angle;
    }
    // Also the derivatives, where the hinge is nearly flat.
    const FoldGradient fold = fold_gradient(stencil, stiffness, turned(1e-4));
    EXPECT_LT((fold - bending_gradient(quadratic, stiffness, turned(1e-4))).norm(), 1e-3 * fold.norm());
}

TEST(Fold, GradientAndHessianAreDerivatives) {
    const FoldStencil stencil = fold_stencil(two_triangles(turned(0.7)), hinge, 0, 1);
    for (const double angle : {-3.1, -1.0, 0.0, 0.4, 1.5, 2.8, 3.14, -3.14}) {
        const HingePositions x = crooked(angle);
        const auto energy = [&](const Eigen::VectorXd& at) { return fold_energy(stencil, stiffness, columns(at)); };
        auto check = test::check_gradient(energy, fold_gradient(stencil, stiffness, x), flat(x), 0.02, 1e-6);
        EXPECT_TRUE(check.passed) << angle << " " << check.message;
        const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            return fold_gradient(stencil, stiffness, columns(at));
        };
        check = test::check_jacobian(gradient, fold_hessian(stencil, stiffness, x), flat(x), 0.02, 1e-6);
        EXPECT_TRUE(check.passed) << angle << " " << check.message;
    }
}

TEST(Fold, MeasureIsTheEnergysRoot) {
    for (const double start : {0.0, 0.8}) {
        const FoldStencil stencil = fold_stencil(two_triangles(turned(start)), hinge, 0, 1);
        for (const double angle : {-2.0, 0.3, 0.8, 2.5}) {
            HingePositions x = crooked(angle);
            for (const bool collapsing : {false, true}) {
                if (collapsing) x.col(2) = x.col(0) + 0.5 * (x.col(1) - x.col(0)) + 0.03 * (x.col(2) - x.col(0));
                const FoldMeasure measure = fold_measure(stencil, x);
                const double energy = fold_energy(stencil, stiffness, x);
                const FoldGradient gradient = fold_gradient(stencil, stiffness, x);
                EXPECT_GT(energy, 0.0);
                EXPECT_NEAR(0.5 * stiffness * measure.value * measure.value, energy, 1e-12 * energy);
                EXPECT_LT((stiffness * measure.value * measure.gradient - gradient).norm(), 1e-10 * gradient.norm());
            }
        }
    }
}

TEST(Fold, ProjectedHessianIsSemidefiniteAndExactAtRest) {
    const FoldStencil stencil = fold_stencil(two_triangles(crooked(0.7)), hinge, 0, 1);
    for (const double angle : {-3.0, 0.0, 0.7, 2.0}) {
        const FoldHessian projected = fold_projected_hessian(stencil, stiffness, crooked(angle));
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<FoldHessian>(projected).eigenvalues();
        EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
    }
    const FoldHessian exact = fold_hessian(stencil, stiffness, crooked(0.7));
    EXPECT_LT((fold_projected_hessian(stencil, stiffness, crooked(0.7)) - exact).norm(), 1e-9 * exact.norm());
}

TEST(Fold, ACollapsingTriangleKeepsItsForceBounded) {
    const FoldStencil stencil = fold_stencil(two_triangles(turned(1.0)), hinge, 0, 1);
    double largest = 0.0;
    for (const double share : {0.2, 0.06, 0.03, 1e-2, 1e-3, 1e-6, 1e-12, 0.0}) {
        HingePositions x = crooked(-0.5);
        const Eigen::Vector3d foot = 0.6 * x.col(0) + 0.4 * x.col(1);
        x.col(3) = foot + share * (x.col(3) - foot);
        const FoldGradient gradient = fold_gradient(stencil, stiffness, x);
        ASSERT_TRUE(gradient.allFinite());
        ASSERT_TRUE(fold_projected_hessian(stencil, stiffness, x).allFinite());
        largest = std::max(largest, gradient.norm());
        if (share > 0.01 || share < 1e-6) continue;
        const auto energy = [&](const Eigen::VectorXd& at) { return fold_energy(stencil, stiffness, columns(at)); };
        const auto check = test::check_gradient(energy, gradient, flat(x), 1e-4 * share, 1e-5);
        EXPECT_TRUE(check.passed) << share << " " << check.message;
    }
    EXPECT_LT(largest, 100.0 * fold_gradient(stencil, stiffness, crooked(-0.5)).norm());
    EXPECT_EQ(fold_gradient(stencil, stiffness, HingePositions::Zero()).norm(), 0.0) << "all four in one point";
}

}  // namespace
}  // namespace toile
