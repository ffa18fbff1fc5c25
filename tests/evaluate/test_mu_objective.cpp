#include <gtest/gtest.h>

#include <cmath>

#include "evaluate/mu_objective.h"
#include "tests/prior/quasistatic_cases.h"
#include "tests/support/derivative_checker.h"

namespace toile::evaluate {
namespace {

using namespace prior::test;

constexpr double tight = 1e-11;  // of the projections, so that differences see the loss and not its error

Eigen::VectorXd wavy(Eigen::Index count, double middle) {
    Eigen::VectorXd x(count);
    for (Eigen::Index i = 0; i < count; ++i) x[i] = middle + std::sin(0.7 * static_cast<double>(i));
    return x;
}

/// Data, smoothness, bounds and conditioning together: what the optimiser sees.
TEST(MuObjective, HasTheDerivativeOfItsValue) {
    const ClothMesh mesh = sheet(5, 5);
    const std::vector<double> truth = joined({draped(mesh), draped(mesh, 0.5)});
    MuLoss loss(prior::QuasistaticModel::from(prior::rest_state(mesh)), tight, {noisy(truth, 1e-3), truth}, 1);
    const MuSmoothing smoothing(mesh.triangle, loss.vertex_count());
    const double unit = loss(Eigen::VectorXd::Constant(loss.vertex_count(), std::log(0.1)), false).squared_error;
    const MuVariables variables(smoothing, 0.01, 1e-4, 1e3);
    MuObjective objective(loss, smoothing, variables, 0.01, unit);
    const Eigen::VectorXd z = variables.of(wavy(loss.vertex_count(), std::log(0.5)));
    Eigen::VectorXd gradient, unused;
    objective(z, gradient);
    const test::DerivativeCheck check =
        test::check_gradient([&](const Eigen::VectorXd& at) { return objective(at, unused); }, gradient, z, 1.0, 1e-5);
    EXPECT_TRUE(check.passed) << check.message;
    EXPECT_LE(objective.best_objective(), objective.history().front().objective);
    EXPECT_EQ(static_cast<Eigen::Index>(objective.best().size()), z.size());
}

}  // namespace
}  // namespace toile::evaluate
