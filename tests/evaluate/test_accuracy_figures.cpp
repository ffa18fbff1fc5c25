#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "evaluate/accuracy_figures.h"

namespace toile::evaluate {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(Judgement, CallsADifferenceWhatItIs) {
    EXPECT_EQ(judge_difference(-1.0, {-1.5, -0.5}, 0.2, 40), Judgement::better);
    EXPECT_EQ(judge_difference(1.0, {0.5, 1.5}, 0.2, 40), Judgement::worse);
    EXPECT_EQ(judge_difference(-1.0, {-1.5, -0.5}, unknown, 40), Judgement::better);
    EXPECT_EQ(judge_difference(-1.0, {-1.5, -0.5}, 1.2, 40), Judgement::below_noise);
    EXPECT_EQ(judge_difference(-1.0, {-2.5, 0.5}, 0.2, 40), Judgement::below_interval);
    EXPECT_EQ(judge_difference(-1.0, {-1.0, -1.0}, 0.2, fewest_samples - 1), Judgement::too_few);
    EXPECT_EQ(judge_difference(0.0, {0.0, 0.0}, 0.2, 40), Judgement::below_interval) << "no difference at all";
}

/// `count` samples of the test split and one of the train split; the prior takes a millimetre off each error.
AccuracyFigures figures_of(int count) {
    AccuracyFigures figures;
    MethodFigures before{"predicted", "the prediction", 0, {}, {}},
        after{"inextensibility@limit=0", "after", 0, {}, {}};
    for (int k = 0; k <= count; ++k) {
        figures.id.push_back(100 + k);
        figures.split.push_back(k == 0 ? 0 : 2);
        QuantityValues values;
        values.fill(0.5);
        at(values, Quantity::sqrt_mse) = 3.0 + k % 7;
        at(values, Quantity::max_dist) = 10.0 + k % 7;
        at(values, Quantity::penetration) = unknown;
        before.sample.push_back(values);
        at(values, Quantity::sqrt_mse) -= 1.0;
        after.sample.push_back(values);
    }
    figures.truth = {"target", {before}};
    figures.truth.method[0].method = "target";
    figures.predictor = {{"ridge", {before, after}}};
    return figures;
}

const files::Metric* find(const AccuracyVerdicts& verdicts, const std::string& name) {
    for (const files::Metric& one : verdicts.metric)
        if (one.name == name) return &one;
    return nullptr;
}

TEST(AccuracyFigures, BecomeMetrics) {
    const AccuracyVerdicts verdicts = judge_figures(figures_of(70), std::nullopt, 1);
    const files::Metric* error = find(verdicts, "accuracy/ridge/test/predicted/sqrt_mse");
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->value, std::sqrt((9 + 16 + 25 + 36 + 49 + 64 + 81) / 7.0), 1e-12);
    EXPECT_EQ(error->samples, 70);
    EXPECT_EQ(error->unit, "mm");
    EXPECT_EQ(error->direction, files::MetricDirection::lower);
    EXPECT_EQ(error->distribution->median, 6.0);
    EXPECT_EQ(error->distribution->largest, 9.0);
    EXPECT_LT(error->low, error->value);
    EXPECT_GT(error->high, error->value);
    EXPECT_FALSE(error->floor);
    ASSERT_TRUE(find(verdicts, "accuracy/ridge/train/predicted/max_dist"));
    EXPECT_EQ(find(verdicts, "accuracy/ridge/train/predicted/max_dist")->value, 10.0);
    EXPECT_FALSE(find(verdicts, "accuracy/ridge/validation/predicted/sqrt_mse")) << "there is no such sample";
    EXPECT_FALSE(find(verdicts, "accuracy/ridge/test/predicted/penetration")) << "there is no body";
    ASSERT_TRUE(find(verdicts, "accuracy/target/test/target/largest_stretch"));
    EXPECT_EQ(find(verdicts, "accuracy/target/test/target/largest_stretch")->direction, files::MetricDirection::none);
}

Judgement judgement_of(const AccuracyVerdicts& verdicts, const std::string& split, Quantity quantity) {
    for (const Comparison& one : verdicts.comparison)
        if (one.split == split && one.quantity == quantity) return one.judgement;
    throw std::runtime_error("not compared");
}

TEST(AccuracyFigures, AreComparedSampleBySample) {
    const AccuracyVerdicts verdicts = judge_figures(figures_of(70), std::nullopt, 1);
    EXPECT_EQ(judgement_of(verdicts, "test", Quantity::sqrt_mse), Judgement::better);
    EXPECT_EQ(judgement_of(verdicts, "test", Quantity::max_dist), Judgement::below_interval);
    EXPECT_EQ(judgement_of(verdicts, "train", Quantity::sqrt_mse), Judgement::too_few);
    EXPECT_THROW(judgement_of(verdicts, "test", Quantity::stretching_energy), std::runtime_error)
        << "more or less energy is neither better nor worse";
}

TEST(AccuracyFigures, AreHeldAgainstTheNoise) {
    NoiseFloor floor;
    floor.value.fill(unknown);
    at(floor.value, Quantity::sqrt_mse) = 2.0;
    const AccuracyVerdicts verdicts = judge_figures(figures_of(70), floor, 1);
    EXPECT_EQ(judgement_of(verdicts, "test", Quantity::sqrt_mse), Judgement::below_noise);
    EXPECT_EQ(*find(verdicts, "accuracy/ridge/test/predicted/sqrt_mse")->floor, 2.0);
    EXPECT_FALSE(find(verdicts, "accuracy/ridge/test/predicted/max_dist")->floor) << "not known";
}

}  // namespace
}  // namespace toile::evaluate
