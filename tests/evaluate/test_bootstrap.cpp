#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "evaluate/bootstrap.h"

namespace toile::evaluate {
namespace {

std::vector<double> drawn(int count, unsigned seed, bool exponential = false) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(3.0, 1.0);
    std::exponential_distribution<double> tail(1.0);
    std::vector<double> value;
    for (int k = 0; k < count; ++k) value.push_back(exponential ? tail(random) : normal(random));
    return value;
}

TEST(Bootstrap, OfAMeanIsItsStandardError) {
    const int count = 400;
    const std::vector<double> value = drawn(count, 1);
    const double mean = gathered(Gather::mean, value);
    const Interval interval = interval_of(Bootstrap(count, 7).figures(Gather::mean, value));
    EXPECT_NEAR(interval.high - mean, 1.96 / std::sqrt(count), 0.012);
    EXPECT_NEAR(mean - interval.low, 1.96 / std::sqrt(count), 0.012);
}

TEST(Bootstrap, HoldsTheTruthNineteenTimesInTwenty) {
    const Bootstrap bootstrap(60, 3);
    int normal = 0, skewed = 0;
    for (unsigned round = 0; round < 300; ++round) {
        const Interval a = interval_of(bootstrap.figures(Gather::mean, drawn(60, 100 + round)));
        const Interval b = interval_of(bootstrap.figures(Gather::mean, drawn(60, 100 + round, true)));
        normal += a.low < 3.0 && 3.0 < a.high;
        skewed += b.low < 1.0 && 1.0 < b.high;
    }
    EXPECT_NEAR(normal, 285, 15);
    EXPECT_NEAR(skewed, 278, 18) << "a little too narrow for what is skewed";
}

TEST(Bootstrap, OfADifferenceIsPaired) {
    const std::vector<double> before = drawn(50, 5);
    std::vector<double> after = before;
    for (double& one : after) one -= 0.25;
    const Bootstrap bootstrap(50, 1);
    const Interval interval =
        interval_of(bootstrap.figures(Gather::mean, after) - bootstrap.figures(Gather::mean, before));
    EXPECT_NEAR(interval.low, -0.25, 1e-12);
    EXPECT_NEAR(interval.high, -0.25, 1e-12);
}

TEST(Bootstrap, GathersRoots) {
    const std::vector<double> value{3, 4};
    EXPECT_DOUBLE_EQ(gathered(Gather::root_of_mean_square, value), std::sqrt(12.5));
    EXPECT_DOUBLE_EQ(gathered(Gather::mean, value), 3.5);
    const Eigen::VectorXd figures = Bootstrap(2, 1).figures(Gather::root_of_mean_square, value);
    for (const double one : figures)
        EXPECT_TRUE(std::abs(one - 3) < 1e-12 || std::abs(one - 4) < 1e-12 || std::abs(one - std::sqrt(12.5)) < 1e-12);
}

TEST(Bootstrap, DependsOnItsSeedAlone) {
    const std::vector<double> value = drawn(20, 2);
    EXPECT_EQ(Bootstrap(20, 4).figures(Gather::mean, value), Bootstrap(20, 4).figures(Gather::mean, value));
    EXPECT_NE(Bootstrap(20, 4).figures(Gather::mean, value), Bootstrap(20, 5).figures(Gather::mean, value));
}

TEST(Bootstrap, OfOneSampleOrNoNumberSaysNothing) {
    const Interval one = interval_of(Bootstrap(1, 1).figures(Gather::mean, std::vector<double>{2.0}));
    EXPECT_EQ(one.low, 2.0);
    EXPECT_EQ(one.high, 2.0);
    const std::vector<double> broken{1.0, std::numeric_limits<double>::quiet_NaN()};
    EXPECT_TRUE(std::isnan(interval_of(Bootstrap(2, 1).figures(Gather::mean, broken)).low));
    EXPECT_TRUE(std::isnan(gathered(Gather::mean, {})));
}

}  // namespace
}  // namespace toile::evaluate
