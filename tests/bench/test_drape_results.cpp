#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/drape_results.h"

namespace toile::bench {
namespace {

DrapeTiming timing(int vertices, double seconds) {
    DrapeTiming timing;
    timing.vertices = vertices;
    timing.unit_milliseconds = 10;
    timing.seconds = {seconds, 3 * seconds, 0.5 * seconds};
    timing.stage = {{"factor", seconds}, {"other", 3 * seconds}};
    timing.iterations = 40;
    timing.accepted_share = 1;
    return timing;
}

DrapeTiming timing_with_error(double seconds, double error) {
    DrapeTiming result = timing(1000, seconds);
    result.error = {error, error, error};
    return result;
}

DrapeResults results() {
    DrapeResults results;
    for (const int vertices : {1000, 3000, 10000})
        results.timing["drape/" + std::to_string(vertices)] = timing(vertices, 1e-4 * std::pow(vertices, 1.2));
    results.timing["solver/implicit/quick"] = timing_with_error(1, 4e-3);
    results.timing["solver/implicit/exact"] = timing_with_error(4, 1e-3);
    results.timing["solver/bullet/quick"] = timing_with_error(1, 9e-3);
    results.timing["solver/xpbd/quick"].refused = "there is no solver xpbd";
    results.peak_memory = 120;
    return results;
}

bool has(const std::vector<files::Metric>& metrics, const std::string& key) {
    return std::any_of(metrics.begin(), metrics.end(), [&](const files::Metric& metric) { return metric.name == key; });
}

TEST(DrapeTiming, TakesQuantilesOfItsDrapes) {
    EXPECT_EQ(timing(1, 2.0).quantile_seconds(0.5), 2.0);
    EXPECT_EQ(timing(1, 2.0).quantile_seconds(0.95), 6.0);
    EXPECT_EQ(timing(1, 2.0).units(), 200.0);
    EXPECT_TRUE(std::isnan(DrapeTiming().median_error()));
}

TEST(DrapeResults, FitsTheExponentToTheSizesAlone) {
    EXPECT_NEAR(results().exponent(), 1.2, 1e-12);
    EXPECT_TRUE(std::isnan(DrapeResults().exponent()));
}

TEST(DrapeResults, ComparesSolversBetweenTheirSettings) {
    EXPECT_NEAR(results().seconds_at_error("implicit", 2e-3), 2.0, 1e-9);
    EXPECT_TRUE(std::isnan(results().seconds_at_error("implicit", 1e-5))) << "none of its settings is so exact";
    EXPECT_TRUE(std::isnan(results().seconds_at_error("bullet", 2e-3))) << "one setting is no line";
    EXPECT_TRUE(std::isnan(results().seconds_at_error("xpbd", 2e-3))) << "refused";
}

TEST(DrapeResults, ListsMetricsWithoutAbsoluteTimes) {
    const std::vector<files::Metric> list = metrics(results());
    for (const char* key : {"drape/1000/median", "drape/3000/percentile_95", "drape/3000/accepted", "exponent",
                            "memory", "solver/implicit/exact/error"})
        EXPECT_TRUE(has(list, key)) << key;
    EXPECT_FALSE(has(list, "solver/xpbd/quick/median"));
    for (const files::Metric& metric : list) EXPECT_TRUE(metric.unit != "s" && metric.unit != "ms") << metric.name;
}

TEST(DrapeResults, TheTableShowsRowsStagesAndRefusals) {
    std::ostringstream out;
    print_drape_table(out, results());
    EXPECT_NE(out.str().find("| solver/implicit/exact | 1000 | 4 | 12 | 400 | 10 | 40 | 100 % of 3 | 1 |"),
              std::string::npos)
        << out.str();
    EXPECT_NE(out.str().find("| share of the time | factor | other |"), std::string::npos);
    EXPECT_NE(out.str().find("refused: solver/xpbd/quick: there is no solver xpbd"), std::string::npos);
    EXPECT_NE(out.str().find("implicit at an error of 2 mm: 2 s"), std::string::npos);
    EXPECT_NE(out.str().find("bullet at an error of 2 mm: not between"), std::string::npos);
}

}  // namespace
}  // namespace toile::bench
