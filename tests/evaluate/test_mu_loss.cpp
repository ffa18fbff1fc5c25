#include <gtest/gtest.h>

#include <cmath>

#include "cloth/error.h"
#include "evaluate/mu_loss.h"
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

TEST(MuLoss, HasTheDerivativeOfItsValue) {
    const ClothMesh mesh = sheet(5, 5);
    const std::vector<double> truth = joined({draped(mesh), draped(mesh, 0.5)});
    MuLoss loss(prior::QuasistaticModel::from(prior::rest_state(mesh)), tight, {noisy(truth, 1e-3), truth}, 1);
    const Eigen::VectorXd x = wavy(loss.vertex_count(), std::log(0.5));
    const MuLoss::Value value = loss(x);
    EXPECT_EQ(value.left_out, 0);
    EXPECT_EQ(value.squared_error, loss(x, false).squared_error) << "the same with and without derivative";
    const test::DerivativeCheck check = test::check_gradient(
        [&](const Eigen::VectorXd& at) { return loss(at, false).squared_error; }, value.gradient, x, 1.0, 1e-5);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(MuLoss, LeavesOutSamplesWithoutDerivative) {
    // Pressed together in its plane but for a hair: to a loose tolerance it rests there, where it is about to buckle.
    const ClothMesh mesh = sheet(9, 12);
    std::vector<double> pressed = at_rest(mesh);
    for (size_t i = 0; i < pressed.size(); i += 3) pressed[i] *= 0.8;
    pressed[2] += 1e-9;
    const std::vector<double> first = at_rest(mesh), last = draped(mesh, 0.5);
    std::vector<double> wide = first, wider = last;  // drawn apart, so that nothing buckles
    for (double& x : wide) x *= 1.1;
    for (double& x : wider) x *= 1.2;
    const auto loss_of = [&](const std::vector<double>& predicted, const std::vector<double>& target) {
        return MuLoss(prior::QuasistaticModel::from(prior::rest_state(mesh)), 0.1, {predicted, target}, 1);
    };
    MuLoss all = loss_of(joined({noisy(wide, 1e-4), pressed, noisy(wider, 1e-4)}), joined({first, first, last}));
    MuLoss others = loss_of(joined({noisy(wide, 1e-4), noisy(wider, 1e-4)}), joined({first, last}));
    const Eigen::VectorXd x = Eigen::VectorXd::Constant(mesh.vertex_count(), std::log(0.1));
    const MuLoss::Value with = all(x), without = others(x);
    EXPECT_EQ(with.left_out, 1);
    EXPECT_EQ(without.left_out, 0);
    // What is left is the others' part of the derivative of the mean over all three.
    EXPECT_LT((1.5 * with.gradient - without.gradient).norm(), 1e-9 * without.gradient.norm());
}

TEST(MuLoss, IsThatOfThePredictionsWhereTheSpringsAreStiff) {
    const ClothMesh mesh = sheet(5, 5);
    const std::vector<double> truth = draped(mesh), predicted = noisy(truth, 1e-3);
    MuLoss loss(prior::QuasistaticModel::from(prior::rest_state(mesh)), 1e-9, {predicted, truth}, 1);
    double sum = 0.0;
    for (size_t i = 0; i < truth.size(); ++i) sum += std::pow(predicted[i] - truth[i], 2);
    EXPECT_DOUBLE_EQ(loss.predicted_squared_error(), sum / mesh.vertex_count());
    const Eigen::VectorXd stiff = Eigen::VectorXd::Constant(mesh.vertex_count(), std::log(1e7));
    EXPECT_NEAR(loss(stiff, false).squared_error / loss.predicted_squared_error(), 1.0, 1e-4);
    EXPECT_THROW(MuLoss(prior::QuasistaticModel::from(prior::rest_state(mesh)), 1e-6, {predicted, {}}, 1), Error);
}

}  // namespace
}  // namespace toile::evaluate
