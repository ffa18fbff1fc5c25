#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "evaluate/quantile_tally.h"

namespace toile::evaluate {
namespace {

TEST(QuantileTally, TellsQuantilesOfMillions) {
    QuantileTally tally;
    std::vector<double> all;
    std::mt19937 random(2);
    std::normal_distribution<double> normal(0.01, 0.05);
    for (int k = 0; k < 200000; ++k) {
        all.push_back(normal(random));
        tally.add(all.back());
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(tally.count(), 200000);
    EXPECT_EQ(tally.smallest(), all.front());
    EXPECT_EQ(tally.largest(), all.back());
    EXPECT_NEAR(tally.mean(), 0.01, 5e-4);
    for (const double share : {0.0, 0.01, 0.25, 0.5, 0.95, 0.99, 1.0}) {
        const double exact = all[static_cast<size_t>(share * 199999.0)];
        EXPECT_NEAR(tally.quantile(share), exact, 2.5e-4 * std::abs(exact)) << share;
    }
}

TEST(QuantileTally, IsExactForEqualNumbers) {
    QuantileTally tally;
    for (int k = 0; k < 1000; ++k) tally.add(1.1);
    EXPECT_DOUBLE_EQ(tally.quantile(0.5), 1.1);
    const QuantileTally::Histogram histogram = tally.histogram(10);
    EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0), 1000);
}

TEST(QuantileTally, CountsWhatIsNotFiniteApart) {
    QuantileTally tally;
    EXPECT_TRUE(std::isnan(tally.quantile(0.5)));
    EXPECT_TRUE(std::isnan(tally.largest()));
    EXPECT_TRUE(tally.histogram(10).edges.empty());
    tally.add(std::nan(""));
    tally.add(INFINITY);
    tally.add(0.0);
    tally.add(-2);
    EXPECT_EQ(tally.count(), 2);
    EXPECT_EQ(tally.not_finite(), 2);
    EXPECT_EQ(tally.largest(), 0);
    EXPECT_EQ(tally.smallest(), -2);
}

TEST(QuantileTally, BinsAllNumbers) {
    QuantileTally tally;
    for (int k = 0; k < 10000; ++k) tally.add(k / 10000.0);
    const QuantileTally::Histogram histogram = tally.histogram(20);
    ASSERT_EQ(histogram.edges.size(), 21u);
    EXPECT_TRUE(std::is_sorted(histogram.edges.begin(), histogram.edges.end()));
    EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0), 10000);
    for (const double count : histogram.counts) EXPECT_NEAR(count, 500, 30);
}

}  // namespace
}  // namespace toile::evaluate
