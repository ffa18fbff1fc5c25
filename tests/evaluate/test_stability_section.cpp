#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/stability_priors.h"
#include "evaluate/stability_results.h"
#include "evaluate/stability_section.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;

class StabilitySection : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_stability_section_" + std::to_string(getpid()));
        fs::create_directory(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    nlohmann::ordered_json section(const std::vector<StabilityOutcome>& outcomes) const {
        write_stability_results((folder_ / "stability.json").string(), outcomes, {});
        return as_json(*stability_section(folder_.string()));
    }
    fs::path folder_;
};

StabilityOutcome sample(int number, double residual) {
    StabilityOutcome one;
    one.solver = "quasistatic/fast";
    one.group = "torn";
    one.name = "problem " + std::to_string(number);
    one.finite = true;
    one.status = "converged";
    StressOutcome& p = one.prior.emplace();
    p.problem = number;
    p.finite = true;
    p.status = prior::Status::converged;
    p.residual = residual;
    p.tolerance = 1e-6;
    return one;
}

TEST_F(StabilitySection, PutsFalseClaimsFirstThenFailures) {
    StabilityOutcome honest = sample(2, 1e-3);
    honest.prior->status = prior::Status::accuracy_not_reached;
    honest.replay = "stability_replay/two.h5";
    StabilityOutcome drape;
    drape.solver = "implicit";
    drape.name = "friction 0, on a table";
    drape.rests = drape.finite = drape.falling = true;
    const auto json = section({drape, sample(1, 1e-7), honest, sample(3, 1e-3)});
    EXPECT_EQ(json.at("id"), "stability");
    const auto& rows = json.at("blocks").at(1).at("rows");
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows.at(0).at(0), "false claim");
    EXPECT_EQ(rows.at(0).at(3), "problem 3");
    EXPECT_EQ(rows.at(1).at(0), "failed");
    EXPECT_EQ(rows.at(1).back(), "stability_replay/two.h5");
    EXPECT_EQ(rows.at(2).at(0), "passed");
    EXPECT_NE(json.at("text").at(0).get<std::string>().find("4 cases: 2 passed, 2 failed, 1 of them"),
              std::string::npos)
        << json.at("text").at(0);
    const auto& solvers = json.at("blocks").at(0).at("rows");
    ASSERT_EQ(solvers.size(), 2u);
    EXPECT_EQ(solvers.at(0).at(4), nullptr) << "a drape claims nothing";
    EXPECT_EQ(solvers.at(1).at(4), 1.0);
}

TEST_F(StabilitySection, ShowsAThousandOfThoseThatPassed) {
    std::vector<StabilityOutcome> outcomes;
    for (int k = 0; k < 1200; ++k) outcomes.push_back(sample(k, 1e-7));
    const auto json = section(outcomes);
    EXPECT_EQ(json.at("blocks").at(1).at("rows").size(), 1000u);
    EXPECT_NE(json.at("blocks").at(1).at("note").get<std::string>().find("200 more"), std::string::npos);
}

TEST_F(StabilitySection, IsNotThereWithoutAFileAndRefusesWhatIsNone) {
    EXPECT_FALSE(stability_section(folder_.string()));
    std::ofstream(folder_ / "stability.json") << "{}";
    EXPECT_THROW(stability_section(folder_.string()), Error);
}

TEST_F(StabilitySection, RefusesRowsThatContradictThemselves) {
    const std::string path = (folder_ / "stability.json").string();
    write_stability_results(path, {sample(1, 1e-7)}, {});
    auto json = nlohmann::ordered_json::parse(std::ifstream(path));
    json["cases"][0]["passed"] = false;
    std::ofstream(path) << json;
    EXPECT_THROW(stability_section(folder_.string()), Error);
}

}  // namespace
}  // namespace toile::evaluate
