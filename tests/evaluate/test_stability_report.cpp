#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth/error.h"
#include "evaluate/stability_picture.h"
#include "evaluate/stability_report.h"
#include "evaluate/stability_results.h"
#include "files/image_file.h"
#include "files/metric_file.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

StabilityOutcome outcome(const std::string& name, const std::string& solver, bool passes) {
    StabilityOutcome one;
    one.group = "friction";
    one.name = name;
    one.solver = solver;
    one.status = passes ? "accepted" : "refused: \"it\" would not, ever";
    one.rests = one.finite = passes;
    one.falling = true;
    one.certificate.seconds = 1.25;
    return one;
}

std::vector<StabilityOutcome> outcomes() {
    return {outcome("friction 0", "implicit", true), outcome("friction 2", "implicit", false),
            outcome("friction 0", "xpbd", true)};
}

TEST(StabilityTable, ShowsEveryCaseAndSumsUpBySolver) {
    const std::string text = stability_table(outcomes());
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 3 + 2);
    EXPECT_THAT(text, HasSubstr("implicit: 1 of 2 cases passed; 1 at rest within the gate, 1 finite"));
    EXPECT_THAT(text, HasSubstr("xpbd: 1 of 1 cases passed"));
    EXPECT_THAT(text, HasSubstr("FAILED"));
    EXPECT_THAT(text, HasSubstr("not measured"));
}

TEST(StabilityPicture, ACellForEachCaseAndSolver) {
    const files::Picture picture = stability_picture(outcomes(), {"implicit", "xpbd"});
    EXPECT_EQ(picture.value.size(), static_cast<size_t>(picture.width) * picture.height * 3);
    const auto has = [&](uint8_t red, uint8_t green, uint8_t blue) {
        for (size_t k = 0; k < picture.value.size(); k += 3)
            if (picture.value[k] == red && picture.value[k + 1] == green && picture.value[k + 2] == blue) return true;
        return false;
    };
    EXPECT_TRUE(has(140, 204, 158)) << "passed";
    EXPECT_TRUE(has(204, 77, 64)) << "refused";
}

class StabilityFiles : public ::testing::Test {
  protected:
    void SetUp() override { folder_ = fs::temp_directory_path() / ("toile_stability_" + std::to_string(getpid())); }
    void TearDown() override { fs::remove_all(folder_); }
    static std::string text_of(const std::string& path) {
        std::ostringstream text;
        text << std::ifstream(path).rdbuf();
        return text.str();
    }
    fs::path folder_;
};

TEST_F(StabilityFiles, LeavesTableFiguresAndPicture) {
    StabilityOptions options;
    options.filter = "friction 2, on a table";
    const StabilitySummary summary = evaluate_stability(options, folder_.string());
    ASSERT_EQ(summary.path.size(), 3u);
    EXPECT_EQ(summary.outcome.size(), 1u);
    const std::string csv = text_of(summary.path[0]);
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
    const std::string header = csv.substr(0, csv.find('\n'));
    const auto json = nlohmann::json::parse(text_of(summary.path[1]));
    EXPECT_EQ(json.at("cases").size(), 1u);
    EXPECT_EQ(json.at("cases").at(0).at("case"), "friction 2, on a table");
    EXPECT_EQ(static_cast<size_t>(std::count(header.begin(), header.end(), ',')) + 1, json.at("cases").at(0).size());
    EXPECT_EQ(json.at("cases").at(0).at("passed"), summary.passed());
    EXPECT_GT(files::read_png(summary.path[2]).width, 100);
}

TEST_F(StabilityFiles, KeepsWhatItIsToldToResumeFrom) {
    StabilityOptions options;
    options.filter = "friction 2, on a table";
    const StabilitySummary first = evaluate_stability(options, folder_.string());
    ASSERT_EQ(first.outcome.size(), 1u);

    StabilityOutcome kept = first.outcome[0];
    kept.certificate.seconds = 12345.0;  // which no run of it takes
    kept.energy_rise = std::numeric_limits<double>::quiet_NaN();
    write_stability_results(first.path[1], {kept, outcome("friction 9, elsewhere", "xpbd", true)}, {});
    options.resume = true;
    options.filter = "on a table";
    options.quick = true;
    const StabilitySummary second = evaluate_stability(options, folder_.string());
    ASSERT_GT(second.outcome.size(), 2u);
    int times = 0;
    for (const StabilityOutcome& one : second.outcome) {
        if (one.name != kept.name) continue;
        ++times;
        EXPECT_EQ(one.certificate.seconds, 12345.0) << "not run again";
        EXPECT_TRUE(std::isnan(one.energy_rise));
        EXPECT_EQ(one.certificate.residual_force, kept.certificate.residual_force);
    }
    EXPECT_EQ(times, 1);
    EXPECT_EQ(second.outcome.back().solver, "xpbd") << "what was there of other solvers stays, in their place";

    options.resume = false;
    options.filter = "friction 2, on a table";
    EXPECT_EQ(evaluate_stability(options, folder_.string()).outcome.size(), 1u);
    std::ofstream(first.path[1]) << "{}";
    options.resume = true;
    EXPECT_THROW(evaluate_stability(options, folder_.string()), Error);
}

TEST_F(StabilityFiles, AreAMetricsFileWithTheSharesThatPassed) {
    fs::create_directory(folder_);
    const std::string path = (folder_ / "stability.json").string();
    write_stability_results(path, outcomes(), {{"filter", "friction"}});
    const files::MetricFile file = files::read_metric_file(path, "stability");
    const auto value = [&](const std::string& name) {
        for (const files::Metric& one : file.metric)
            if (one.name == name) return one;
        throw Error("there is no " + name);
    };
    EXPECT_EQ(value("stability/implicit/passed_share").value, 50.0);
    EXPECT_EQ(value("stability/implicit/passed_share").direction, files::MetricDirection::higher);
    EXPECT_EQ(value("stability/implicit/not_finite").value, 1.0);
    EXPECT_EQ(value("stability/xpbd/passed_share").value, 100.0);
    EXPECT_EQ(value("stability/xpbd/seconds").direction, files::MetricDirection::none);
    EXPECT_EQ(file.about.at(0).value, "friction");
}

TEST_F(StabilityFiles, SayWhereAFailedDrapeIsRunAgainFromUntilItPasses) {
    StabilityOptions options;
    options.filter = "friction 0, on a table";
    options.budget = {1, 0};
    const StabilitySummary failed = evaluate_stability(options, folder_.string());
    ASSERT_FALSE(failed.passed());
    const std::string replay = failed.outcome[0].replay;
    EXPECT_EQ(replay, "stability_replay/implicit_friction_0_on_a_table.h5");
    EXPECT_TRUE(fs::exists(folder_ / replay));
    EXPECT_THAT(failed.outcome[0].command, HasSubstr("toile simulate --replay " + replay));
    EXPECT_THAT(text_of(failed.path[0]), HasSubstr(replay));
    EXPECT_EQ(read_stability_results(failed.path[1]).at(0).replay, replay);

    options.budget = {};
    ASSERT_TRUE(evaluate_stability(options, folder_.string()).passed());
    EXPECT_FALSE(fs::exists(folder_ / "stability_replay"));
}

TEST_F(StabilityFiles, RefusesAPlaceThatIsAFile) {
    std::ofstream(folder_) << "in the way";
    EXPECT_THROW(evaluate_stability({}, folder_.string()), Error);
}

}  // namespace
}  // namespace toile::evaluate
