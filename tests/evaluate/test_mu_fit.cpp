#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cloth/error.h"
#include "evaluate/mu_fit.h"
#include "evaluate/mu_loss.h"
#include "generate/ordered_work.h"
#include "tests/prior/quasistatic_cases.h"

namespace toile::evaluate {
namespace {

using prior::test::draped;
using prior::test::sheet;
using ::testing::HasSubstr;

constexpr int columns = 9, rows = 12;

/// Curved sheets, and predictions of them with noise: `lower` of the first half of the rows, `upper` of the others.
struct Corpus {
    Corpus(int count, double lower, double upper) : mesh(sheet(columns, rows)) {
        for (int i = 0; i < count; ++i) {
            target.push_back(draped(mesh, 0.5 + 0.03 * i, 0.15 + 0.004 * i, 1.0 + 0.1 * i));
            predicted.push_back(target.back());
            std::mt19937 random(static_cast<unsigned>(i));
            std::normal_distribution<double> normal(0.0, 1.0);
            for (int v = 0; v < columns * rows; ++v)
                for (int c = 0; c < 3; ++c)
                    predicted.back()[static_cast<size_t>(3 * v + c)] +=
                        (v / columns < rows / 2 ? lower : upper) * normal(random);
        }
    }
    MuSamples samples() const {
        return {static_cast<int>(target.size()), [this](int i, std::span<double> r, std::span<double> t) {
                    std::copy(predicted[static_cast<size_t>(i)].begin(), predicted[static_cast<size_t>(i)].end(),
                              r.begin());
                    std::copy(target[static_cast<size_t>(i)].begin(), target[static_cast<size_t>(i)].end(), t.begin());
                }};
    }
    ClothPairs pairs() const { return {prior::test::joined(predicted), prior::test::joined(target)}; }

    ClothMesh mesh;
    std::vector<std::vector<double>> predicted, target;
};

MuFitOptions quick() {
    MuFitOptions options;
    options.smoothness = {0.03, 0.003};
    return options;
}

double error_at(const Corpus& corpus, double mu) {
    MuLoss loss(prior::QuasistaticModel::from(prior::rest_state(corpus.mesh)), 1e-6, corpus.pairs(), 1);
    return std::sqrt(loss(Eigen::VectorXd::Constant(loss.vertex_count(), std::log(mu)), false).squared_error);
}

TEST(FitMu, FindsWhatASweepFinds) {
    const Corpus corpus(8, 2e-3, 2e-3);
    MuFitOptions options = quick();
    options.per_vertex = false;
    const MuFit fit = fit_mu(corpus.mesh, corpus.samples(), corpus.samples(), options);
    EXPECT_EQ(fit.global.status, MuStatus::converged);
    EXPECT_EQ(fit.samples, 8);
    EXPECT_EQ(fit.vertex.mu.size(), 0);
    constexpr double ratio = 1.05;  // of the sweep: its best is within one step of the minimum
    double best = 0.0, least = 1.0;
    for (double mu = 1e-3; mu < 10.0; mu *= ratio)
        if (const double error = error_at(corpus, mu); error < least) {
            least = error;
            best = mu;
        }
    EXPECT_LT(std::abs(std::log(fit.global.mu / best)), std::log(ratio) + 0.01);
    EXPECT_LE(fit.global.train.fitted, least * (1.0 + 1e-4));
    EXPECT_DOUBLE_EQ(fit.global.train.fitted, error_at(corpus, fit.global.mu));
    EXPECT_DOUBLE_EQ(fit.global.train.reference, error_at(corpus, 0.1));
    EXPECT_GT(fit.global.train.predicted, fit.global.train.fitted);
    EXPECT_EQ(fit.global.validation.fitted, fit.global.train.fitted) << "the same samples";
}

TEST(FitMu, IsStifferWherePredictionsAreBetter) {
    const Corpus train(12, 3e-3, 3e-4), validation(6, 3e-3, 3e-4);
    const MuFit fit = fit_mu(train.mesh, train.samples(), validation.samples(), quick());
    ASSERT_EQ(fit.vertex.mu.size(), columns * rows);
    const int half = columns * rows / 2;
    const double noisy = fit.vertex.mu.head(half).array().log().mean();
    const double good = fit.vertex.mu.tail(half).array().log().mean();
    EXPECT_GT(good - noisy, std::log(2.0));
    EXPECT_LT(noisy, std::log(fit.global.mu));
    EXPECT_GT(good, std::log(fit.global.mu));
    EXPECT_LT(fit.vertex.train.fitted, 0.97 * fit.global.train.fitted);
    EXPECT_LT(fit.vertex.validation.fitted, fit.global.validation.fitted);
    EXPECT_EQ(fit.left_out, 0);
    EXPECT_GT(fit.vertex.mu.minCoeff(), 1e-4);
    EXPECT_LT(fit.vertex.mu.maxCoeff(), 1e3);
    EXPECT_THAT(fit.sentence, HasSubstr("Per vertex"));
}

TEST(FitMu, DoesNotDependOnTheThreads) {
    const Corpus corpus(20, 3e-3, 3e-4);
    MuFitOptions options = quick();
    options.samples = 17;
    const MuFit one = fit_mu(corpus.mesh, corpus.samples(), {}, options);
    options.jobs = 3;
    const MuFit three = fit_mu(corpus.mesh, corpus.samples(), {}, options);
    EXPECT_EQ(one.global.mu, three.global.mu);
    EXPECT_EQ(one.vertex.mu, three.vertex.mu);
    EXPECT_EQ(one.vertex.train.fitted, three.vertex.train.fitted);
    EXPECT_EQ(one.samples, 13);
    EXPECT_EQ(one.validation_samples, 4) << "every fourth of the 17 drawn";
    EXPECT_EQ(one.samples_offered, 20);
    options.seed = 1;
    EXPECT_NE(fit_mu(corpus.mesh, corpus.samples(), {}, options).global.mu, one.global.mu) << "other samples";
}

TEST(FitMu, GoesToTheBoundWhereThePredictionsAreExact) {
    const Corpus corpus(6, 0.0, 0.0);
    const MuFit fit = fit_mu(corpus.mesh, corpus.samples(), corpus.samples(), quick());
    EXPECT_EQ(fit.global.status, MuStatus::at_upper_bound);
    EXPECT_EQ(fit.global.mu, 1e3);
    EXPECT_EQ(fit.global.train.predicted, 0.0);
    EXPECT_THAT(fit.sentence, HasSubstr("the bound 1000"));
    EXPECT_TRUE(fit.vertex.mu.allFinite());
}

TEST(FitMu, GoesToTheLowerBoundWhereTheTruthIsFarFromThePredictions) {
    Corpus corpus(4, 0.0, 0.0);
    for (std::vector<double>& one : corpus.predicted) {
        one = prior::test::at_rest(corpus.mesh);
        for (double& x : one) x *= 3.0;
    }
    for (std::vector<double>& one : corpus.target) one = prior::test::at_rest(corpus.mesh);
    // Stretched threefold about the same middle: the softer the target springs, the closer to rest.
    const Eigen::Map<const Positions> rest(corpus.target[0].data(), columns * rows, 3);
    const Eigen::RowVector3d middle = rest.colwise().mean();
    for (size_t i = 0; i < corpus.predicted.size(); ++i) {
        Eigen::Map<Positions> predicted(corpus.predicted[i].data(), columns * rows, 3);
        predicted.rowwise() -= 2.0 * middle;
    }
    MuFitOptions options = quick();
    options.per_vertex = false;
    options.low = 0.01;
    const MuFit fit = fit_mu(corpus.mesh, corpus.samples(), corpus.samples(), options);
    EXPECT_EQ(fit.global.status, MuStatus::at_lower_bound);
    EXPECT_EQ(fit.global.mu, 0.01);
}

TEST(FitMu, RefusesOneDefectAtATime) {
    const Corpus corpus(2, 1e-3, 1e-3);
    const auto refused = [&](const MuFitOptions& options) {
        EXPECT_THROW(fit_mu(corpus.mesh, corpus.samples(), {}, options), Error);
    };
    MuFitOptions wrong;
    wrong.low = 0.0;
    refused(wrong);
    wrong = {};
    wrong.high = wrong.low;
    refused(wrong);
    wrong = {};
    wrong.reference = 1e4;
    refused(wrong);
    wrong = {};
    wrong.samples = 0;
    refused(wrong);
    wrong = {};
    wrong.validation_samples = -1;
    refused(wrong);
    wrong = {};
    wrong.smoothness.clear();
    refused(wrong);
    wrong = {};
    wrong.smoothness = {0.0};
    refused(wrong);
    wrong = {};
    wrong.iterations = 0;
    refused(wrong);
    wrong = {};
    wrong.jobs = 0;
    refused(wrong);
    EXPECT_THROW(fit_mu(corpus.mesh, {}, corpus.samples(), {}), Error) << "no train sample";
    Corpus broken = corpus;
    broken.predicted[1][5] = std::nan("");
    EXPECT_THROW(fit_mu(broken.mesh, broken.samples(), {}, {}), Error) << "not finite";
}

TEST(FitMu, CanBeInterrupted) {
    const Corpus corpus(2, 1e-3, 1e-3);
    const std::atomic<bool> interrupted = true;
    MuFitOptions options;
    options.interrupted = &interrupted;
    EXPECT_THROW(fit_mu(corpus.mesh, corpus.samples(), {}, options), generate::Interrupted);
}

}  // namespace
}  // namespace toile::evaluate
