#include <gtest/gtest.h>

#include <cmath>

#include "evaluate/mu_smoothing.h"
#include "tests/prior/quasistatic_cases.h"

namespace toile::evaluate {
namespace {

using namespace prior::test;

Eigen::VectorXd wavy(Eigen::Index count, double middle) {
    Eigen::VectorXd x(count);
    for (Eigen::Index i = 0; i < count; ++i) x[i] = middle + std::sin(0.7 * static_cast<double>(i));
    return x;
}

TEST(MuVariables, KeepWithinTheBoundsAndComeBack) {
    const ClothMesh mesh = sheet(6, 4);
    const MuSmoothing smoothing(mesh.triangle, mesh.vertex_count());
    const MuVariables variables(smoothing, 0.1, 1e-4, 1e3);
    const Eigen::VectorXd x = wavy(mesh.vertex_count(), std::log(0.3));
    EXPECT_LT((variables.log_mu(variables.of(x)) - x).cwiseAbs().maxCoeff(), 1e-10);
    const Eigen::VectorXd far = variables.log_mu(1e3 * variables.of(x));
    EXPECT_LE(far.maxCoeff(), std::log(1e3));
    EXPECT_GE(far.minCoeff(), std::log(1e-4));
}

TEST(MuSmoothing, IsTheDirichletEnergyWhateverTheMesh) {
    // x = 3 times the place along the sheet: ½ ∫ |∇x|² dA = 4.5 times the area, for regular triangles exactly, but for
    // the jagged sides, where half of the rows end half a triangle later.
    for (const double side : {0.02, 0.01}) {
        const ClothMesh mesh = sheet(41, 31, side, 0.0);
        const MuSmoothing smoothing(mesh.triangle, mesh.vertex_count());
        const Eigen::VectorXd x = 3.0 * mesh.rest_position.col(1);
        const double energy = 0.5 * x.dot(smoothing.laplacian() * x);
        const double area = 40 * side * 30 * 0.866 * side;
        EXPECT_NEAR(energy, 4.5 * area, 1e-3 * area);
        const Eigen::VectorXd even = Eigen::VectorXd::Ones(mesh.vertex_count());
        EXPECT_LT((smoothing.laplacian() * even).cwiseAbs().maxCoeff(), 1e-12);
    }
}

}  // namespace
}  // namespace toile::evaluate
