#include <gtest/gtest.h>

#include <cmath>

#include "evaluate/study.h"

namespace toile::evaluate {
namespace {

TEST(PowerLaw, FindsTheExponentOfExactData) {
    std::vector<double> x, y;
    for (const double one : {100.0, 300.0, 1000.0, 5000.0}) {
        x.push_back(one);
        y.push_back(2e-5 * std::pow(one, 1.3));
    }
    const PowerLaw law = fit_power_law(x, y);
    EXPECT_NEAR(law.exponent, 1.3, 1e-12);
    EXPECT_NEAR(law.factor, 2e-5, 1e-15);
    EXPECT_NEAR(law.exponent_low, 1.3, 1e-6);
    EXPECT_NEAR(law.exponent_high, 1.3, 1e-6);
}

TEST(PowerLaw, TellsHowSureItIs) {
    // log y = 0, 1, 1 at log x = 0, 1, 2: slope 1/2, residual sum of squares 1/6, standard error sqrt(1/12)
    const double e = std::exp(1.0);
    const PowerLaw law = fit_power_law({1.0, e, e * e}, {1.0, e, e});
    EXPECT_NEAR(law.exponent, 0.5, 1e-12);
    EXPECT_NEAR(law.exponent_high - law.exponent, 2.0 * std::sqrt(1.0 / 12.0), 1e-12);
}

TEST(PowerLaw, SaysNothingOfTooLittle) {
    EXPECT_TRUE(std::isnan(fit_power_law({}, {}).exponent));
    EXPECT_TRUE(std::isnan(fit_power_law({2.0}, {1.0}).exponent));
    EXPECT_TRUE(std::isnan(fit_power_law({2.0, 2.0}, {1.0, 3.0}).exponent)) << "one size only";
    EXPECT_TRUE(std::isnan(fit_power_law({2.0, 3.0}, {0.0, 3.0}).exponent)) << "no logarithm of zero";
    EXPECT_TRUE(std::isnan(fit_power_law({1.0, 2.0}, {1.0, 2.0}).exponent_low)) << "two points leave no doubt to judge";
}

TEST(StudyMetrics, GateRatiosAndNotSeconds) {
    Study study;
    study.name = "priors";
    Timings timings(1, 2);
    timings.add_unit(0.5);
    timings.add_round(0, {1.0, 3.0});
    add_time_metrics(study, "cone@1e-06", timings, 0, 2);
    ASSERT_EQ(study.metric.size(), 2u);
    EXPECT_EQ(study.metric[0].name, "runtime/priors/cone@1e-06/seconds");
    EXPECT_EQ(study.metric[0].direction, files::MetricDirection::none);
    EXPECT_DOUBLE_EQ(study.metric[0].value, 2.0);
    EXPECT_EQ(study.metric[1].name, "runtime/priors/cone@1e-06/time_ratio");
    EXPECT_EQ(study.metric[1].direction, files::MetricDirection::lower);
    EXPECT_EQ(study.metric[1].unit, "ratio");
    EXPECT_DOUBLE_EQ(study.metric[1].value, 4.0);
}

}  // namespace
}  // namespace toile::evaluate
