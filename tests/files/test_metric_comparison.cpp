#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "files/metric_comparison.h"

namespace toile::files {
namespace {

using Outcome = MetricChange::Outcome;

Metric metric(const std::string& name, double value, MetricDirection direction = MetricDirection::lower) {
    Metric one;
    one.name = name;
    one.value = value;
    one.unit = "mm";
    one.direction = direction;
    one.tolerance = 0.05;
    return one;
}

Outcome outcome(const Metric& baseline, const Metric& measured) {
    return compare_metrics({baseline}, {measured}).at(0).outcome;
}

TEST(MetricComparison, worse_than_the_tolerance_is_a_regression_in_either_direction) {
    EXPECT_EQ(outcome(metric("a", 10), metric("a", 10.51)), Outcome::regressed);
    EXPECT_EQ(outcome(metric("a", 10), metric("a", 10.49)), Outcome::within);
    EXPECT_EQ(outcome(metric("a", 10), metric("a", 9.51)), Outcome::within);
    EXPECT_EQ(outcome(metric("a", 10), metric("a", 9.49)), Outcome::improved);
    const MetricDirection higher = MetricDirection::higher;
    EXPECT_EQ(outcome(metric("a", 10, higher), metric("a", 9.49, higher)), Outcome::regressed);
    EXPECT_EQ(outcome(metric("a", 10, higher), metric("a", 10.51, higher)), Outcome::improved);
}

TEST(MetricComparison, the_baseline_judges) {
    EXPECT_EQ(outcome(metric("a", 10, MetricDirection::none), metric("a", 99)), Outcome::untold);
    Metric lax = metric("a", 20);
    lax.tolerance = 5;
    EXPECT_EQ(outcome(metric("a", 10), lax), Outcome::regressed);
}

TEST(MetricComparison, a_negative_baseline_has_a_tolerance_too) {
    EXPECT_EQ(outcome(metric("a", -10), metric("a", -9.6)), Outcome::within);
    EXPECT_EQ(outcome(metric("a", -10), metric("a", -9.4)), Outcome::regressed);
}

TEST(MetricComparison, of_a_baseline_of_nothing_anything_is_worse) {
    EXPECT_EQ(outcome(metric("failed", 0), metric("failed", 1)), Outcome::regressed);
    EXPECT_EQ(outcome(metric("failed", 0), metric("failed", 0)), Outcome::within);
}

TEST(MetricComparison, within_the_noise_of_both_intervals_is_no_regression) {
    Metric before = metric("a", 10), now = metric("a", 14);
    before.low = 7, before.high = 13;  // half width 3
    now.low = 10, now.high = 18;       // half width 4: hypot 5
    EXPECT_DOUBLE_EQ(allowed_change(before, now), 5.0);
    EXPECT_EQ(outcome(before, now), Outcome::within);
    now.value = 15.1;
    EXPECT_EQ(outcome(before, now), Outcome::regressed);
}

TEST(MetricComparison, below_the_floor_is_no_regression) {
    Metric before = metric("a", 10), now = metric("a", 11.9);
    EXPECT_EQ(outcome(before, now), Outcome::regressed);
    now.floor = 2;
    EXPECT_EQ(outcome(before, now), Outcome::within);
    now.floor.reset();
    before.floor = 2;
    EXPECT_EQ(outcome(before, now), Outcome::within);
    before.floor = std::nan("");
    EXPECT_EQ(outcome(before, now), Outcome::regressed);
}

TEST(MetricComparison, what_is_not_measured_is_missing) {
    EXPECT_EQ(outcome(metric("a", 10), metric("a", std::nan(""))), Outcome::missing);
    Metric metres = metric("a", 0.01);
    metres.unit = "m";
    EXPECT_EQ(outcome(metric("a", 10), metres), Outcome::missing);
    EXPECT_EQ(outcome(metric("a", std::nan("")), metric("a", 10)), Outcome::untold);
    const auto changes = compare_metrics({metric("a", 10), metric("told", 1, MetricDirection::none)}, {});
    EXPECT_EQ(changes.at(0).outcome, Outcome::missing);
    EXPECT_EQ(changes.at(1).outcome, Outcome::untold);
    EXPECT_TRUE(changes.at(0).trips());
    EXPECT_FALSE(changes.at(1).trips());
}

TEST(MetricComparison, regressions_come_first_and_what_was_added_last) {
    const auto changes =
        compare_metrics({metric("same", 1), metric("gone", 1), metric("worse", 1), metric("better", 1)},
                        {metric("new", 5), metric("better", 0.5), metric("worse", 2), metric("same", 1)});
    std::vector<std::string> names;
    for (const MetricChange& change : changes) names.push_back(change.name());
    EXPECT_THAT(names, testing::ElementsAre("worse", "gone", "same", "better", "new"));
}

TEST(MetricComparison, a_line_says_all) {
    const auto changes = compare_metrics({metric("a", 10), metric("b", 10)}, {metric("a", 12)});
    EXPECT_EQ(changes[0].line(), "a: 12 mm, baseline 10 mm, worse by 2, allowed 0.5");
    EXPECT_EQ(changes[1].line(), "b: not measured, baseline 10 mm");
}

}  // namespace
}  // namespace toile::files
