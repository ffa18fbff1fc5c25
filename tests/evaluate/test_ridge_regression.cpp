#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "evaluate/ridge_regression.h"

namespace toile::evaluate {
namespace {

struct Data {
    Eigen::MatrixXd feature, target;  // a row a sample, centred

    RidgeSums sums() const {
        RidgeSums sums(feature.cols(), target.cols());
        for (Eigen::Index i = 0; i < feature.rows(); ++i) sums.add(feature.row(i), target.row(i));
        return sums;
    }
    double size() const { return feature.squaredNorm() / static_cast<double>(feature.rows()); }
    /// The generalised cross-validation score from the hat matrix itself, in the space without the mean.
    double score(double ridge) const {
        const Eigen::Index n = feature.rows();
        const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(n, 1);
        const Eigen::MatrixXd turn = ones.householderQr().householderQ();
        const Eigen::MatrixXd axes = turn.rightCols(n - 1);
        const Eigen::MatrixXd kernel = axes.transpose() * feature * feature.transpose() * axes;
        const double penalty = ridge * size();
        const Eigen::MatrixXd rest =
            penalty * (kernel + penalty * Eigen::MatrixXd::Identity(n - 1, n - 1)).inverse();  // 1 less the hat matrix
        const double mean = rest.trace() / static_cast<double>(n);
        return (rest * axes.transpose() * target).squaredNorm() / static_cast<double>(n) / (mean * mean);
    }
};

/// Targets linear in the features, plus noise.
Data noisy(Eigen::Index samples, Eigen::Index features, double noise) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    const auto draw = [&] { return normal(random); };
    Data data;
    data.feature = Eigen::MatrixXd::NullaryExpr(samples, features, draw);
    const Eigen::MatrixXd weights = Eigen::MatrixXd::NullaryExpr(features, 2, draw);
    data.target = data.feature * weights + noise * Eigen::MatrixXd::NullaryExpr(samples, 2, draw);
    data.feature.rowwise() -= data.feature.colwise().mean().eval();
    data.target.rowwise() -= data.target.colwise().mean().eval();
    return data;
}

TEST(RidgeRegression, SolvesTheNormalEquations) {
    const Data data = noisy(40, 6, 0.5);
    for (const double ridge : {1e-6, 0.3, 20.0}) {
        const RidgeFit fit = fit_ridge(data.sums(), ridge);
        const Eigen::MatrixXd normal =
            data.feature.transpose() * data.feature + ridge * data.size() * Eigen::MatrixXd::Identity(6, 6);
        const Eigen::MatrixXd expected = normal.ldlt().solve(data.feature.transpose() * data.target);
        EXPECT_LT((fit.weights.transpose() - expected).cwiseAbs().maxCoeff(), 1e-12) << ridge;
        EXPECT_EQ(fit.ridge, ridge);
        EXPECT_NEAR(fit.cross_error, std::sqrt(data.score(ridge)), 1e-9) << ridge;
    }
}

TEST(RidgeRegression, ChoosesTheStrengthThatForeseesLeast) {
    for (const auto& [samples, features, noise] : {std::tuple(40, 6, 0.5), {40, 30, 3.0}, {15, 30, 1.0}}) {
        const Data data = noisy(samples, features, noise);
        const RidgeFit fit = fit_ridge(data.sums(), std::nullopt);
        EXPECT_GT(fit.ridge, 0);
        EXPECT_NEAR(fit.cross_error, std::sqrt(data.score(fit.ridge)), 1e-6 * fit.cross_error);
        for (const double other : {0.1, 0.5, 2.0, 10.0})
            EXPECT_LE(data.score(fit.ridge), data.score(other * fit.ridge) * 1.05) << samples << " " << other;
    }
}

TEST(RidgeRegression, NoiseAsksForMoreStrength) {
    EXPECT_LT(fit_ridge(noisy(40, 20, 0.01).sums(), std::nullopt).ridge,
              fit_ridge(noisy(40, 20, 10.0).sums(), std::nullopt).ridge);
}

TEST(RidgeRegression, ForeseesTheErrorOnOtherSamples) {
    const Data data = noisy(4000, 5, 0.5);  // two targets of variance 0.25 each
    EXPECT_NEAR(fit_ridge(data.sums(), std::nullopt).cross_error, std::sqrt(0.5), 0.02);
}

TEST(RidgeRegression, FeaturesThatRepeatShareTheirWeight) {
    Data data = noisy(40, 3, 0.1);
    data.feature.conservativeResize(40, 4);
    data.feature.col(3) = data.feature.col(0);
    const RidgeFit fit = fit_ridge(data.sums(), 0.0);
    ASSERT_TRUE(fit.weights.allFinite());
    EXPECT_NEAR(fit.weights(0, 0), fit.weights(0, 3), 1e-9);
    EXPECT_TRUE(std::isfinite(fit.cross_error));
}

TEST(RidgeRegression, WithoutFeaturesPredictsTheMean) {
    RidgeSums none(0, 2);
    none.add(Eigen::VectorXd(0), Eigen::Vector2d(3, 4));
    none.add(Eigen::VectorXd(0), Eigen::Vector2d(-3, -4));
    const RidgeFit fit = fit_ridge(none, std::nullopt);
    EXPECT_EQ(fit.weights.rows(), 2);
    EXPECT_EQ(fit.weights.cols(), 0);
    EXPECT_EQ(fit.cross_error, 5);
    RidgeSums still(1, 1);  // a feature that never changes
    still.add(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1));
    EXPECT_EQ(fit_ridge(still, std::nullopt).weights(0, 0), 0);
}

}  // namespace
}  // namespace toile::evaluate
