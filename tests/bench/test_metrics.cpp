#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "bench/metrics.h"
#include "cloth/error.h"

namespace toile::bench {
namespace {

class MetricsFile : public testing::Test {
  protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        file_ = testing::TempDir() + "toile_metrics_" + test->name() + ".json";
    }
    void TearDown() override { std::filesystem::remove(file_); }
    void write(const std::string& text) { std::ofstream(file_) << text; }
    std::string file_;
};

const std::vector<Metric> baseline{{"time", 1.0, "factorisations", true, 0.2}, {"rate", 50, "1/s", false, 0.1}};

TEST_F(MetricsFile, ReadsWhatWasWritten) {
    write_metrics(baseline, file_);
    const std::vector<Metric> read = read_metrics(file_);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].key, "time");
    EXPECT_EQ(read[0].unit, "factorisations");
    EXPECT_TRUE(read[0].lower_is_better);
    EXPECT_EQ(read[1].value, 50);
    EXPECT_FALSE(read[1].lower_is_better);
    EXPECT_EQ(read[1].tolerance, 0.1);
}

TEST_F(MetricsFile, RefusesWhatIsNoBaseline) {
    EXPECT_THROW(read_metrics(file_), Error) << "no file";
    for (const char* text : {"", "{", "[]", R"({"metrics": [{"key": "a"}]})", R"({"metrics": 3})",
                             R"({"metrics": [{"key": "a", "value": "b", "unit": "", "direction": "lower",
                                              "tolerance": 1}]})",
                             R"({"metrics": [{"key": "a", "value": 1, "unit": "", "direction": "up",
                                              "tolerance": 1}]})"}) {
        write(text);
        EXPECT_THROW(read_metrics(file_), Error) << text;
    }
}

TEST_F(MetricsFile, CannotBeWrittenWhereThereIsNoFolder) {
    EXPECT_THROW(write_metrics(baseline, testing::TempDir() + "no/such/folder/x.json"), Error);
}

TEST(Metrics, WithinTheToleranceIsNoRegression) {
    EXPECT_TRUE(regressions(baseline, {{"time", 1.19, "", true, 0}, {"rate", 45.5, "", false, 0}}).empty());
    EXPECT_TRUE(regressions(baseline, {{"time", 0.1, "", true, 0}, {"rate", 500, "", false, 0}}).empty());
}

TEST(Metrics, WorseMissingAndNotANumberAreRegressions) {
    const auto lines = regressions(baseline, {{"time", 1.21, "", true, 0}, {"rate", 44, "", false, 0}});
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_NE(lines[0].find("time: 1.21"), std::string::npos) << lines[0];
    EXPECT_EQ(regressions(baseline, {{"rate", 50, "", false, 0}}).size(), 1u);
    EXPECT_EQ(regressions(baseline, {{"time", std::nan(""), "", true, 0}, {"rate", 50, "", false, 0}}).size(), 1u);
}

}  // namespace
}  // namespace toile::bench
