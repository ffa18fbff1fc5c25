#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/speed_results.h"

namespace toile::bench {
namespace {

SpeedResults results() {
    SpeedResults results;
    results.timing["unit/cholmod_default"] = {20, 0, "METIS", {}};
    results.timing["inextensibility/interior_point/1e-6/forward/batch"] = {30, 9, {}, {}};
    results.timing["inextensibility/cone/1e-6/forward/batch"] = {0, 0, {}, "sample 3 did not reach its tolerance"};
    for (int vertices : {1000, 2000, 4000, 8000})
        results.timing["scaling/inextensibility/forward/" + std::to_string(vertices)] = {
            std::pow(vertices, 1.25), 9, {}, {}};
    results.peak_memory["inextensibility"] = 100;
    return results;
}

bool has(const std::vector<files::Metric>& metrics, const std::string& key) {
    return std::any_of(metrics.begin(), metrics.end(), [&](const files::Metric& metric) { return metric.name == key; });
}

TEST(SpeedResults, CountsInFactorisations) {
    EXPECT_DOUBLE_EQ(results().units("inextensibility/interior_point/1e-6/forward/batch"), 1.5);
    EXPECT_TRUE(std::isnan(results().units("inextensibility/cone/1e-6/forward/batch")));
    EXPECT_TRUE(std::isnan(results().units("no/such/row")));
}

TEST(SpeedResults, FitsTheExponent) {
    EXPECT_NEAR(results().exponent("inextensibility/forward"), 1.25, 1e-12);
    EXPECT_TRUE(std::isnan(results().exponent("quasistatic/forward")));
}

TEST(SpeedResults, ListsMetricsOfWhatWasTimedAlone) {
    const std::vector<files::Metric> list = metrics(results());
    EXPECT_TRUE(has(list, "inextensibility/interior_point/1e-6/forward/batch"));
    EXPECT_TRUE(has(list, "inextensibility/interior_point/1e-6/forward/batch/steps"));
    EXPECT_FALSE(has(list, "inextensibility/cone/1e-6/forward/batch"));
    EXPECT_TRUE(has(list, "scaling/inextensibility/forward"));
    EXPECT_TRUE(has(list, "memory/inextensibility"));
    for (const files::Metric& metric : list) EXPECT_NE(metric.unit, "ms") << metric.name;
}

TEST(SpeedResults, TheTableShowsTargetsAndRefusals) {
    std::ostringstream out;
    print_speed_table(out, results());
    EXPECT_NE(out.str().find("| inextensibility | interior_point | 1e-6 | forward | batch | 1.5 | 1 | 30 | 9 |"),
              std::string::npos)
        << out.str();
    EXPECT_NE(out.str().find("refused: inextensibility/cone/1e-6/forward/batch: sample 3"), std::string::npos);
}

}  // namespace
}  // namespace toile::bench
