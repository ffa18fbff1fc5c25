#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

#include "cloth/error.h"
#include "tests/prior/quasistatic_cases.h"
#include "tests/support/derivative_checker.h"

namespace toile::prior::test {
namespace {

struct Case {
    ClothMesh mesh;
    Quasistatic prior;
    std::vector<double> predicted;
    QuasistaticSolution solution;

    Case(int columns, int rows, double noise, double mu = 0.1)
        : mesh(sheet(columns, rows)),
          prior(QuasistaticModel::from(rest_state(mesh), {}, mu), tight()),
          predicted(noisy(draped(mesh), noise)),
          solution(projected(prior, predicted)) {}

    static QuasistaticOptions tight() {
        QuasistaticOptions options;
        options.tolerance = 1e-12;
        return options;
    }
    Eigen::Map<const Eigen::VectorXd> r_hat() const {
        return {predicted.data(), static_cast<Eigen::Index>(predicted.size())};
    }
    Eigen::Map<const Eigen::VectorXd> r() const {
        return {solution.position.data(), static_cast<Eigen::Index>(solution.position.size())};
    }
};

QuasistaticGradient backward(const Case& c, const std::vector<double>& loss_gradient) {
    Quasistatic::Workspace workspace(c.prior);
    QuasistaticGradient gradient;
    c.prior.backward(c.predicted, c.solution, loss_gradient, gradient, workspace);
    return gradient;
}

double weighted(const std::vector<double>& weight, const std::vector<double>& x) {
    double sum = 0.0;
    for (size_t i = 0; i < x.size(); ++i) sum += weight[i] * x[i];
    return sum;
}

TEST(QuasistaticDerivative, ByThePredictionMeetsFiniteDifferences) {
    for (const auto& [columns, rows] : {std::pair{3, 2}, std::pair{4, 5}, std::pair{7, 6}}) {
        const Case c(columns, rows, 0.003);
        const std::vector<double> weight = random_numbers(c.predicted.size(), 7);
        const auto loss = [&](const Eigen::VectorXd& r_hat) {
            return weighted(weight, projected(c.prior, {r_hat.data(), r_hat.data() + r_hat.size()}).position);
        };
        const QuasistaticGradient gradient = backward(c, weight);
        EXPECT_EQ(gradient.report[0].status, Status::converged);
        EXPECT_TRUE(gradient.report[0].positive_definite);
        const Eigen::Map<const Eigen::VectorXd> by_prediction(gradient.predicted.data(), c.r_hat().size());
        const auto check = toile::test::check_gradient(loss, by_prediction, c.r_hat(), 0.01, 1e-6);
        EXPECT_TRUE(check.passed) << check.message;
    }
}

TEST(QuasistaticDerivative, ByMuOfEachVertexMeetsFiniteDifferences) {
    const Case c(4, 4, 0.003);
    const std::vector<double> weight = random_numbers(c.predicted.size(), 8);
    Quasistatic prior(c.prior.model(), Case::tight());
    const auto loss = [&](const Eigen::VectorXd& mu) {
        prior.set_mu(mu);
        return weighted(weight, projected(prior, c.predicted).position);
    };
    const QuasistaticGradient gradient = backward(c, weight);
    const Eigen::Map<const Eigen::VectorXd> by_mu(gradient.mu_vertex.data(), 16);
    const auto check = toile::test::check_gradient(loss, by_mu, Eigen::VectorXd::Constant(16, 0.1), 0.1, 1e-6);
    EXPECT_TRUE(check.passed) << check.message;
    EXPECT_NEAR(gradient.mu[0], by_mu.sum(), 1e-12 * by_mu.cwiseAbs().sum());
}

TEST(QuasistaticDerivative, ByTheModuliMeetsFiniteDifferences) {
    const Case c(4, 4, 0.003);
    const std::vector<double> weight = random_numbers(c.predicted.size(), 9);
    const auto loss = [&](const Eigen::VectorXd& factor) {
        QuasistaticModel model = c.prior.model();
        model.edge_stiffness *= factor[0];
        model.bending_stiffness *= factor[1];
        model.axial_stiffness *= factor[2];
        return weighted(weight, projected(Quasistatic(model, Case::tight()), c.predicted).position);
    };
    const QuasistaticGradient gradient = backward(c, weight);
    const Eigen::Vector3d by_moduli(gradient.stretch[0], gradient.bending[0], gradient.axial[0]);
    const auto check = toile::test::check_gradient(loss, by_moduli, Eigen::Vector3d::Ones(), 1.0, 1e-6);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(QuasistaticDerivative, MeetsTheDenseHessian) {
    const Case c(6, 6, 0.004);
    const std::vector<double> weight = random_numbers(c.predicted.size(), 10);
    const Eigen::Map<const Eigen::VectorXd> g(weight.data(), c.r().size());
    const Eigen::VectorXd eta = dense_hessian(c.prior.model(), c.r()).ldlt().solve(g);
    const QuasistaticGradient gradient = backward(c, weight);
    for (Eigen::Index i = 0; i < eta.size(); ++i)
        EXPECT_NEAR(gradient.predicted[static_cast<size_t>(i)], c.prior.model().target_stiffness[i / 3] * eta[i],
                    1e-9 * eta.cwiseAbs().maxCoeff() * c.prior.model().target_stiffness.maxCoeff());
    EXPECT_LT(gradient.report[0].linear_residual, 1e-11);
}

TEST(QuasistaticDerivative, TheTwoProductsAreTransposed) {
    for (const size_t count : {1u, 11u}) {
        Case c(9, 8, 0.003);
        std::vector<std::vector<double>> samples;
        for (size_t i = 0; i < count; ++i) samples.push_back(noisy(draped(c.mesh), 0.001 * (1.0 + i), 20 + i));
        c.predicted = joined(samples);
        c.solution = projected(c.prior, c.predicted);
        const size_t size = samples[0].size();
        const std::vector<double> weight = random_numbers(count * size, 1);
        std::vector<double> move = random_numbers(count * size, 2), mu = random_numbers(count * size / 3, 3);
        for (double& x : move) x *= 0.01;
        for (double& x : mu) x *= 0.1;
        const std::vector<double> stretch = random_numbers(count, 4), bending = random_numbers(count, 5),
                                  axial = random_numbers(count, 6);
        const QuasistaticGradient gradient = backward(c, weight);
        Quasistatic::Workspace workspace(c.prior);
        QuasistaticTangent tangent;
        c.prior.tangent(c.predicted, c.solution, {move, mu, stretch, bending, axial}, tangent, workspace);
        for (size_t i = 0; i < count; ++i) {
            double forward = 0.0, backward = gradient.stretch[i] * stretch[i] + gradient.bending[i] * bending[i] +
                                             gradient.axial[i] * axial[i];
            for (size_t k = i * size; k < (i + 1) * size; ++k) {
                forward += weight[k] * tangent.position[k];
                backward += gradient.predicted[k] * move[k];
            }
            for (size_t k = i * size / 3; k < (i + 1) * size / 3; ++k) backward += gradient.mu_vertex[k] * mu[k];
            EXPECT_NEAR(forward / backward, 1.0, 1e-9) << i;
        }
    }
}

TEST(QuasistaticDerivative, ASaddleIsReported) {
    // A strip pressed together in its plane, exactly flat: it wants to buckle, and nothing tells it where to.
    const ClothMesh mesh = sheet(8, 3);
    const Quasistatic prior(QuasistaticModel::from(rest_state(mesh), {}, 1e-3));
    std::vector<double> flat = at_rest(mesh);
    for (size_t i = 0; i < flat.size(); i += 3) flat[i] *= 0.8;
    QuasistaticSolution solution;
    solution.position = flat;
    const Eigen::Map<const Eigen::VectorXd> r(flat.data(), static_cast<Eigen::Index>(flat.size()));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense_hessian(prior.model(), r));
    ASSERT_LT(eigen.eigenvalues()[0], 0.0);
    Quasistatic::Workspace workspace(prior);
    QuasistaticGradient gradient;
    prior.backward(flat, solution, random_numbers(flat.size(), 3), gradient, workspace);
    EXPECT_FALSE(gradient.report[0].positive_definite);
    EXPECT_LT(gradient.report[0].linear_residual, 1e-8);
    // The prior itself does not stop there.
    prior.project(flat, solution, workspace);
    EXPECT_EQ(solution.report[0].status, Status::converged);
    const Eigen::Map<const Eigen::VectorXd> end(solution.position.data(), r.size());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense_hessian(prior.model(), end)).eigenvalues()[0], 0.0);
}

TEST(QuasistaticDerivative, RejectedSamplesGetNoNumbers) {
    Case c(5, 5, 0.003);
    const size_t size = c.predicted.size();
    const std::vector<double> good = c.predicted;
    std::vector<double> bad = good;
    bad[3] = std::numeric_limits<double>::quiet_NaN();
    c.predicted = joined({good, bad, good});
    c.solution = projected(c.prior, c.predicted);
    const QuasistaticGradient gradient = backward(c, random_numbers(3 * size, 2));
    EXPECT_EQ(gradient.report[1].status, Status::rejected_input);
    EXPECT_TRUE(std::isnan(gradient.predicted[size]) && std::isnan(gradient.mu[1]) && std::isnan(gradient.stretch[1]));
    EXPECT_EQ(gradient.report[2].status, Status::converged);
    EXPECT_TRUE(std::isfinite(gradient.predicted[2 * size]) && std::isfinite(gradient.mu[2]));
}

TEST(QuasistaticDerivative, WrongSizesAreRefused) {
    const Case c(4, 4, 0.003);
    Quasistatic::Workspace workspace(c.prior);
    QuasistaticGradient gradient;
    QuasistaticTangent tangent;
    EXPECT_THROW(c.prior.backward(c.predicted, c.solution, std::vector<double>(47), gradient, workspace), Error);
    const std::vector<double> two(2);
    QuasistaticChange change;
    change.stretch = two;
    EXPECT_THROW(c.prior.tangent(c.predicted, c.solution, change, tangent, workspace), Error);
}

}  // namespace
}  // namespace toile::prior::test
