#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "cloth/tension_field.h"
#include "tests/cloth/one_triangle.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

using test::columns;
using test::deformed_by;
using test::flat;
using test::one_triangle;

const MembraneStiffness wrinkling = MembraneStiffness::from_moduli(300.0, 500.0, 40.0, 0.3, Compression::tension_field);
const MembraneStiffness full = MembraneStiffness::from_moduli(300.0, 500.0, 40.0, 0.3, Compression::full);

double quadratic(const MembraneStiffness& c, const Eigen::Vector3d& e) {
    return 0.5 * (c.uu * e[0] * e[0] + c.vv * e[1] * e[1] + c.shear * e[2] * e[2]) + c.uv * e[0] * e[1];
}

/// Strains (ε_uu, ε_vv, 2 ε_uv) that wrinkle: squeezed along weft, along warp, across the bias; p > 0 and p < 0.
const std::vector<Eigen::Vector3d> wrinkled = {{0.1, -0.2, 0.02},  {-0.3, 0.05, -0.1}, {0.02, 0.03, 0.6},
                                               {-0.2, -0.1, 0.35}, {0.1, -0.1, 0.0},   {-0.15, -0.05, -0.25}};

TEST(TensionField, TautIsStVenantKirchhoff) {
    for (const Eigen::Vector3d& strain : {Eigen::Vector3d(0.1, 0.05, 0.04), Eigen::Vector3d(0.2, -0.01, 0.0)}) {
        const TensionField field = tension_field(wrinkling, strain);
        EXPECT_NEAR(field.energy, quadratic(wrinkling, strain), 1e-12);
        EXPECT_NEAR(field.stress[2], 40.0 * strain[2], 1e-12);
        EXPECT_NEAR(field.tangent(0, 1), wrinkling.uv, 1e-10);
    }
    const ClothMesh mesh = one_triangle();
    const TrianglePositions x = deformed_by(mesh, {1.1, 0.02, 0.1}, {0.05, 1.2, 0.0});
    const MembraneStencil stencil = membrane_stencil(mesh, 0);
    EXPECT_LT((membrane_gradient(stencil, wrinkling, x) - membrane_gradient(stencil, full, x)).norm(), 1e-12);
}

TEST(TensionField, SlackIsForceless) {
    for (const Eigen::Vector3d& strain : {Eigen::Vector3d(-0.1, -0.05, 0.04), Eigen::Vector3d(-0.5, -0.5, 0.0)}) {
        const TensionField field = tension_field(wrinkling, strain);
        EXPECT_EQ(field.energy, 0.0);
        EXPECT_EQ(field.stress.norm(), 0.0);
    }
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    const TrianglePositions point = TrianglePositions::Zero();
    EXPECT_EQ(membrane_gradient(stencil, wrinkling, point).norm(), 0.0);
    EXPECT_EQ(membrane_projected_hessian(stencil, wrinkling, point).norm(), 0.0);
}

TEST(TensionField, EnergyIsTheLeastOverWrinkles) {
    for (const Eigen::Vector3d& strain : wrinkled) {
        const double relaxed = tension_field(wrinkling, strain).energy;
        double least = quadratic(wrinkling, strain);
        for (int direction = 0; direction < 2000; ++direction) {
            const double angle = M_PI * direction / 2000.0, c = std::cos(angle), s = std::sin(angle);
            const Eigen::Vector3d wrinkle(c * c, s * s, 2.0 * c * s);
            // The best amount of this wrinkle, in closed form: quadratic in the amount.
            const double second = 2.0 * quadratic(wrinkling, wrinkle);
            const double slope = quadratic(wrinkling, strain + wrinkle) - quadratic(wrinkling, strain) - 0.5 * second;
            const double amount = std::max(0.0, -slope / second);
            least = std::min(least, quadratic(wrinkling, strain + amount * wrinkle));
        }
        EXPECT_LE(relaxed, least * (1.0 + 1e-12));
        EXPECT_NEAR(relaxed / least, 1.0, 1e-5);
    }
}

TEST(TensionField, StressIsSemidefiniteAndTheEnergysDerivative) {
    for (const Eigen::Vector3d& strain : wrinkled) {
        const TensionField field = tension_field(wrinkling, strain);
        EXPECT_NEAR(field.stress[0] * field.stress[1], field.stress[2] * field.stress[2], 1e-9);
        EXPECT_GE(field.stress[0] + field.stress[1], 0.0);
        const auto energy = [](const Eigen::VectorXd& at) { return tension_field(wrinkling, at).energy; };
        auto check = test::check_gradient(energy, field.stress, strain, 0.1, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
        const auto stress = [](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            return tension_field(wrinkling, at).stress;
        };
        check = test::check_jacobian(stress, field.tangent, strain, 0.1, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
    }
}

TEST(TensionField, PulledAlongOneAxisItMeetsTheModulus) {
    // However narrow the cloth is held, only E_u ε_uu remains.
    for (const double lateral : {-0.05, -0.2, -0.45}) {
        const TensionField field = tension_field(wrinkling, {0.1, lateral, 0.0});
        EXPECT_NEAR(field.stress[0], 300.0 * 0.1, 1e-9);
        EXPECT_NEAR(field.energy, 0.5 * 300.0 * 0.01, 1e-11);
    }
}

TEST(TensionField, StressIsContinuousBetweenStates) {
    // A path from taut through wrinkled to slack.
    Eigen::Vector3d before = tension_field(wrinkling, {0.1, 0.1, 0.05}).stress;
    for (int k = 1; k <= 4000; ++k) {
        const double t = k / 4000.0;
        const Eigen::Vector3d stress = tension_field(wrinkling, {0.1 - 0.25 * t, 0.1 - 0.5 * t, 0.05}).stress;
        EXPECT_LT((stress - before).norm(), 0.3);
        before = stress;
    }
    EXPECT_EQ(before.norm(), 0.0);
}

TEST(TensionField, TheMembraneIsConvexWithItsTrueHessian) {
    const ClothMesh mesh = one_triangle();
    const MembraneStencil stencil = membrane_stencil(mesh, 0);
    const std::vector<TrianglePositions> shape = {
        deformed_by(mesh, {1.1, 0.1, 0.2}, {0.1, 0.6, 0.3}), deformed_by(mesh, {0.7, 0.0, 0.1}, {-0.4, 1.05, 0.0}),
        deformed_by(mesh, {-1.0, 0.2, 0.0}, {0.0, 1.1, 0.1}), deformed_by(mesh, {0.2, 0.1, 0.0}, {0.1, 0.3, 0.0})};
    for (const TrianglePositions& x : shape) {
        const TriangleHessian hessian = membrane_hessian(stencil, wrinkling, x);
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<TriangleHessian>(hessian).eigenvalues();
        EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff());
        EXPECT_LT((hessian - membrane_projected_hessian(stencil, wrinkling, x)).norm(), 1e-9 * (1 + hessian.norm()));
        for (const TrianglePositions& y : shape)
            EXPECT_LE(membrane_energy(stencil, wrinkling, 0.5 * (x + y)),
                      0.5 * (membrane_energy(stencil, wrinkling, x) + membrane_energy(stencil, wrinkling, y)) + 1e-12);
    }
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return membrane_gradient(stencil, wrinkling, columns(at));
    };
    const auto check =
        test::check_jacobian(gradient, membrane_hessian(stencil, wrinkling, shape[0]), flat(shape[0]), 0.03, 1e-6);
    EXPECT_TRUE(check.passed) << check.message;
}

}  // namespace
}  // namespace toile
