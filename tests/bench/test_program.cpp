#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "bench/figures.h"
#include "bench/program.h"
#include "cloth/error.h"

namespace toile::bench {
namespace {

std::vector<files::Metric> seconds(double value) {
    return {metric("drape", value, "factorisations", 0.1)};
}

TEST(Program, ComparesWithTheBaselineItWrote) {
    const std::string file = (std::filesystem::temp_directory_path() / "toile_test_program.json").string();
    std::ostringstream out;
    EXPECT_EQ(measure_against(
                  {"", file, "bench"}, [] { return seconds(10.0); }, out),
              0);
    EXPECT_EQ(out.str(), "");
    EXPECT_EQ(measure_against(
                  {file, "", "bench"}, [] { return seconds(10.5); }, out),
              0);
    EXPECT_NE(out.str().find("no regression"), std::string::npos);
    EXPECT_EQ(measure_against(
                  {file, "", "bench"}, [] { return seconds(12.0); }, out),
              1);
    EXPECT_NE(out.str().find("regression: drape"), std::string::npos);
    std::filesystem::remove(file);
}

TEST(Program, RefusesTheBaselineOfAnotherBench) {
    const std::string file = (std::filesystem::temp_directory_path() / "toile_test_other_bench.json").string();
    std::ostringstream out;
    const auto measure = [] { return seconds(10.0); };
    EXPECT_EQ(measure_against({"", file, "bench"}, measure, out), 0);
    EXPECT_THROW(measure_against({file, "", "another"}, measure, out), Error);
    std::filesystem::remove(file);
}

TEST(Program, ReadsTheBaselineBeforeItMeasures) {
    std::ostringstream out;
    bool measured = false;
    const auto measure = [&measured] {
        measured = true;
        return seconds(1.0);
    };
    EXPECT_THROW(measure_against({"/no/such/file", "", "bench"}, measure, out), Error);
    EXPECT_FALSE(measured);
}

TEST(Program, ExitStatusTellsWhoIsAtFault) {
    EXPECT_EQ(run_program("bench", [] { return 3; }), 3);
    EXPECT_EQ(run_program("bench", []() -> int { throw Error("no such row", "--filter"); }), 2);
    EXPECT_EQ(run_program("bench", []() -> int { throw std::runtime_error("out of luck"); }), 1);
}

}  // namespace
}  // namespace toile::bench
