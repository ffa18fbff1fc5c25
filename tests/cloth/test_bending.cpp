#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "cloth/bending.h"
#include "cloth/topology.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

/// Two triangles that share the edge from (0, 0) to (0, 0.02).
ClothMesh two_triangles() {
    ClothMesh mesh;
    mesh.triangle.resize(2, 3);
    mesh.triangle << 0, 1, 2, 1, 0, 3;
    mesh.pattern_triangle = mesh.triangle;
    mesh.pattern_position.resize(4, 2);
    mesh.pattern_position << 0, 0, 0, 0.02, -0.017, 0.008, 0.02, 0.013;
    mesh.rest_position = Positions::Zero(4, 3);
    mesh.rest_position.leftCols(2) = mesh.pattern_position;
    return mesh;
}
const Eigen::Vector4i hinge(0, 1, 2, 3);

HingePositions folded(double angle) {
    HingePositions x = two_triangles().rest_position.transpose();
    x.col(3) << 0.02 * std::cos(angle), 0.013, 0.02 * std::sin(angle);
    return x;
}

TEST(Bending, FlatCostsNothing) {
    const BendingStencil stencil = bending_stencil(two_triangles(), hinge, 0, 1);
    EXPECT_NEAR(bending_energy(stencil, 2e-5, folded(0.0)), 0.0, 1e-25);
    EXPECT_LT(bending_gradient(stencil, 2e-5, folded(0.0)).norm(), 1e-15);
}

TEST(Bending, FoldedMeetsTheHingeFormula) {
    // E = ½ k / (A0 + A1) (2 |e| sin(θ/2))², whatever the angle, as long as lengths are kept.
    const BendingStencil stencil = bending_stencil(two_triangles(), hinge, 0, 1);
    const double area = 0.5 * 0.02 * 0.017 + 0.5 * 0.02 * 0.02;
    for (double angle : {0.1, 1.0, 2.5, 3.14159}) {
        const double expected = 0.5 * 2e-5 / area * std::pow(2.0 * 0.02 * std::sin(0.5 * angle), 2);
        EXPECT_NEAR(bending_energy(stencil, 2e-5, folded(angle)) / expected, 1.0, 1e-9) << angle;
    }
}

TEST(Bending, GradientIsTheEnergysDerivative) {
    const BendingStencil stencil = bending_stencil(two_triangles(), hinge, 0, 1);
    const HingePositions x = folded(0.8);
    const auto energy = [&](const Eigen::VectorXd& at) {
        return bending_energy(stencil, 2e-5, Eigen::Map<const HingePositions>(at.data()));
    };
    const auto check = test::check_gradient(energy, bending_gradient(stencil, 2e-5, x),
                                            Eigen::Map<const Eigen::VectorXd>(x.data(), 12), 0.02, 1e-7);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(Bending, HessianIsTheGradientsDerivativeAndSemidefinite) {
    const BendingStencil stencil = bending_stencil(two_triangles(), hinge, 0, 1);
    const Eigen::Matrix4d weight = bending_hessian(stencil, 2e-5);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(12, 12);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) hessian.block<3, 3>(3 * i, 3 * j) = weight(i, j) * Eigen::Matrix3d::Identity();
    const HingePositions x = folded(0.8);
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return bending_gradient(stencil, 2e-5, Eigen::Map<const HingePositions>(at.data()));
    };
    const auto check =
        test::check_jacobian(gradient, hessian, Eigen::Map<const Eigen::VectorXd>(x.data(), 12), 0.02, 1e-7);
    EXPECT_TRUE(check.passed) << check.message;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(weight).eigenvalues().minCoeff(), -1e-9 * weight.norm());
}

/// Bending energy per area, over ½ k κ², of a plane lattice with sides p, q and p - q that is rolled up around an axis
/// at `angle`: one hinge of each family stands for all.
double rolled_energy_ratio(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double angle, double curvature) {
    const Eigen::Vector2d across(std::cos(angle), std::sin(angle)), along(-across.y(), across.x());
    double energy = 0.0;
    const std::pair<Eigen::Vector2d, Eigen::Vector2d> family[] = {{p, q}, {q, q - p}, {q - p, -p}};
    for (const auto& [edge, apex] : family) {
        ClothMesh mesh = two_triangles();
        mesh.pattern_position.row(0).setZero();
        mesh.pattern_position.row(1) = edge.transpose();
        mesh.pattern_position.row(2) = apex.transpose();
        mesh.pattern_position.row(3) = (edge - apex).transpose();
        HingePositions x;
        for (int v = 0; v < 4; ++v) {
            const Eigen::Vector2d at = mesh.pattern_position.row(v).transpose();
            const double turn = curvature * at.dot(across);
            x.col(v) << std::sin(turn) / curvature, (1.0 - std::cos(turn)) / curvature, at.dot(along);
        }
        energy += bending_energy(bending_stencil(mesh, hinge, 0, 1), 1.0, x);
    }
    const double area = std::abs(p.x() * q.y() - p.y() * q.x());  // of the two triangles that have one of each family
    return energy / area / (0.5 * curvature * curvature);
}

TEST(Bending, ACylinderCostsItsRigidity) {
    for (double angle = 0.0; angle < 3.2; angle += 0.2)
        EXPECT_NEAR(rolled_energy_ratio({0.01, 0}, {0.005, 0.01 * std::sqrt(0.75)}, angle, 5.0), 1.0, 1e-3);
    for (const double angle : {0.0, 0.5 * M_PI})
        EXPECT_NEAR(rolled_energy_ratio({0.01, 0}, {0, 0.01}, angle, 5.0), 1.0, 1e-3);
}

TEST(Bending, StiffnessScalesTheEnergyAlone) {
    const BendingStencil stencil = bending_stencil(two_triangles(), hinge, 0, 1);
    EXPECT_NEAR(bending_energy(stencil, 4e-5, folded(1.0)), 2.0 * bending_energy(stencil, 2e-5, folded(1.0)), 1e-18);
}

}  // namespace
}  // namespace toile
