#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "tests/cloth/one_triangle.h"
#include "tests/support/derivative_checker.h"

namespace toile {
namespace {

using test::columns;
using test::flat;
using test::one_triangle;

const MembraneStiffness jersey = MembraneStiffness::from_moduli(300.0, 500.0, 120.0, 0.3);

/// Stretched, compressed and inverted corners, all of them sheared and turned out of the plane.
std::vector<TrianglePositions> deformed() {
    const TrianglePositions rest = one_triangle().rest_position.transpose();
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity(), squeeze = stretch;
    stretch << 1.2, 0.1, 0, 0, 1.1, 0, 0.3, 0.2, 1;
    squeeze << 0.6, 0.1, 0, -0.1, 0.7, 0, 0.2, -0.1, 1;
    Eigen::Matrix3d mirror = Eigen::Vector3d(-0.9, 1.1, 1.0).asDiagonal();
    return {stretch * rest, squeeze * rest, mirror * rest};
}

TEST(Membrane, RestAndRigidMotionCostNothing) {
    const ClothMesh mesh = one_triangle();
    const MembraneStencil stencil = membrane_stencil(mesh, 0);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const TrianglePositions x = (turn * mesh.rest_position.transpose()).colwise() + Eigen::Vector3d(5, -2, 1);
    EXPECT_NEAR(membrane_energy(stencil, jersey, x), 0.0, 1e-20);
    EXPECT_LT(membrane_gradient(stencil, jersey, x).norm(), 1e-10);
}

TEST(Membrane, UniaxialStretchMeetsTheModulus) {
    // Stretched along u and free to narrow along v by the right amount: ψ = ½ E_u ε_uu².
    const ClothMesh mesh = one_triangle();
    const double strain = 1e-3, lateral = -0.3 * std::sqrt(300.0 / 500.0) * strain;
    TrianglePositions x = mesh.rest_position.transpose();
    x.row(0) *= std::sqrt(1.0 + 2.0 * strain);
    x.row(1) *= std::sqrt(1.0 + 2.0 * lateral);
    const MembraneStencil stencil = membrane_stencil(mesh, 0);
    EXPECT_NEAR(membrane_energy(stencil, jersey, x) / stencil.area, 0.5 * 300.0 * strain * strain, 1e-10);
}

TEST(Membrane, GradientIsTheEnergysDerivative) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const TrianglePositions& x : deformed()) {
        const auto energy = [&](const Eigen::VectorXd& at) { return membrane_energy(stencil, jersey, columns(at)); };
        const auto check = test::check_gradient(energy, membrane_gradient(stencil, jersey, x), flat(x), 0.03, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
    }
}

TEST(Membrane, HessianIsTheGradientsDerivative) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const TrianglePositions& x : deformed()) {
        const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            return membrane_gradient(stencil, jersey, columns(at));
        };
        const auto check = test::check_jacobian(gradient, membrane_hessian(stencil, jersey, x), flat(x), 0.03, 1e-7);
        EXPECT_TRUE(check.passed) << check.message;
    }
}

TEST(Membrane, ProjectedHessianIsPositiveSemidefiniteAndExactInTension) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    for (const TrianglePositions& x : deformed()) {
        const TriangleHessian projected = membrane_projected_hessian(stencil, jersey, x);
        const Eigen::SelfAdjointEigenSolver<TriangleHessian> eigen(projected);
        EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-9 * eigen.eigenvalues().maxCoeff());
    }
    const TrianglePositions tense = deformed().front();
    EXPECT_LT((membrane_projected_hessian(stencil, jersey, tense) - membrane_hessian(stencil, jersey, tense)).norm(),
              1e-12 * membrane_hessian(stencil, jersey, tense).norm());
    const TrianglePositions compressed = deformed()[1];
    EXPECT_GT((membrane_projected_hessian(stencil, jersey, compressed) - membrane_hessian(stencil, jersey, compressed))
                  .norm(),
              1e-3 * membrane_hessian(stencil, jersey, compressed).norm());
}

TEST(Membrane, SofteningIsWhatTheProjectionTook) {
    const MembraneStencil stencil = membrane_stencil(one_triangle(), 0);
    double largest = 0.0;
    const TrianglePositions rest = one_triangle().rest_position.transpose();
    Eigen::Matrix3d pressed = Eigen::Matrix3d::Identity(), folding = pressed;  // too little for the squeeze to act
    pressed << 0.95, 0.02, 0, -0.01, 0.93, 0, 0.2, -0.1, 1;
    folding << 1.1, 0.05, 0, 0.02, 0.92, 0, 0.1, 0.1, 1;
    for (const TrianglePositions& x :
         {deformed().front(), TrianglePositions(pressed * rest), TrianglePositions(folding * rest)}) {
        const TriangleHessian exact = membrane_hessian(stencil, jersey, x);
        const Eigen::Matrix3d softening = membrane_softening(stencil, jersey, x);
        TriangleHessian restored = membrane_projected_hessian(stencil, jersey, x);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                restored.block<3, 3>(3 * i, 3 * j) += softening(i, j) * Eigen::Matrix3d::Identity();
        EXPECT_LT((restored - exact).norm(), 1e-12 * exact.norm());
        largest = std::max(largest, softening.norm());
    }
    EXPECT_GT(largest, 0.0);
}

}  // namespace
}  // namespace toile
