#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cloth/error.h"
#include "evaluate/stability_priors.h"
#include "evaluate/stability_replay.h"
#include "files/problem_file.h"
#include "files/projection_file.h"
#include "generate/project.h"
#include "generate/validate.h"

namespace toile::evaluate {
namespace {

namespace fs = std::filesystem;

class StabilityReplay : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_stability_replay_" + std::to_string(getpid()));
        fs::create_directory(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// A case that one step of one try is not enough for.
    StabilityOutcome failed_case(const std::string& name) const {
        for (const StabilityCase& one : stability_cases())
            if (one.name == name) return run_stability_case(one, "implicit", {1, 0}, folder_.string());
        throw Error("there is no case " + name);
    }
    fs::path folder_;
};

TEST_F(StabilityReplay, ACaseWithoutABodyEndsWhereItDid) {
    const StabilityOutcome failed = failed_case("friction 0, on a table");
    ASSERT_FALSE(failed.passed());
    ASSERT_TRUE(is_case_replay(path(failed.replay)));
    EXPECT_TRUE(generate::validate_file(path(failed.replay), {}).defect.empty());
    const ReplayedCase again = replay_case(path(failed.replay), {}, path("cloth.obj"));
    EXPECT_TRUE(again.replayed.same_inputs);
    EXPECT_TRUE(again.replayed.same_cloth);
    EXPECT_TRUE(again.replayed.same_certificate);
    EXPECT_FALSE(again.outcome.passed());
    EXPECT_EQ(again.outcome.status, failed.status);
    EXPECT_TRUE(fs::exists(path("cloth.obj")));
}

TEST_F(StabilityReplay, ACaseWithABodyToo) {
    const StabilityOutcome failed = failed_case("time step 0.001 s, on a bending pillar");
    ASSERT_FALSE(failed.passed());
    EXPECT_TRUE(replay_case(path(failed.replay), {}, path("cloth.ply")).replayed.same_cloth);
}

TEST_F(StabilityReplay, WithMoreIterationsItPasses) {
    const StabilityOutcome failed = failed_case("friction 0, on a table");
    const ReplayedCase again =
        replay_case(path(failed.replay), {"case.max_iterations=5000", "case.tries=3"}, path("cloth.obj"));
    EXPECT_TRUE(again.outcome.passed());
    EXPECT_FALSE(again.replayed.same_inputs);
    EXPECT_THROW(replay_case(path(failed.replay), {"case.patience=1"}, path("cloth.obj")), Error);
    EXPECT_THROW(replay_case(path(failed.replay), {"case.name=elsewhere"}, path("cloth.obj")), Error);
}

/// The keys of a command as `toile project` takes them.
std::vector<std::string> overrides_of(const std::string& command) {
    std::vector<std::string> keys;
    std::istringstream words(command);
    for (std::string word; words >> word;)
        if (word == "--set" && words >> word) keys.push_back(word);
    return keys;
}

/// Makes failures of a problem's outcomes, keeps it, and projects the file as its command says.
void expect_same_projection(const fs::path& folder, const PriorSuite& suite, int number) {
    const StressProblem problem = draw_problem(suite.draw, number);
    StressSolution solution;
    const std::vector<StressOutcome> found = solve_problem(problem, StressRoute::own, solution);
    std::vector<StabilityOutcome> outcomes(1);
    outcomes[0].prior = found[0];
    outcomes[0].prior->residual = 1.0;
    keep_problem(folder.string(), problem, suite.draw, StressRoute::own, solution, outcomes);
    ASSERT_FALSE(outcomes[0].replay.empty());

    const bool quasistatic = problem.prior == PriorKind::quasistatic;
    generate::ProjectOptions options;
    options.problem = (folder / outcomes[0].replay).string();
    options.out = (folder / "projection.h5").string();
    options.gradient = problem.check_derivative;
    EXPECT_EQ(files::ProblemFile(options.problem).has_target(), problem.check_derivative);
    const generate::ProjectSummary summary = generate::project(
        generate::read_project_config(quasistatic ? generate::Prior::quasistatic : generate::Prior::inextensibility,
                                      overrides_of(outcomes[0].command)),
        options);
    EXPECT_EQ(summary.samples, problem.sample_count());
    const files::Hdf5File file = files::Hdf5File::open(options.out);
    const files::Array<double> projected =
        file.read<double>("/samples/projected", {problem.sample_count(), problem.mesh.vertex_count(), 3});
    double scale = 0.0, apart = 0.0;
    for (std::size_t k = 0; k < solution.position.size(); ++k) {
        scale = std::max(scale, std::abs(solution.position[k]));
        apart = std::max(apart, std::abs(solution.position[k] - projected.value[k]));
    }
    EXPECT_LE(apart, problem.mu_varies ? 1e-6 * scale : 0.0) << problem.description(0);
}

TEST_F(StabilityReplay, AProblemIsProjectedToTheSamePositions) {
    PriorSuite suite;
    suite.draw.largest = 60;
    bool inextensibility = false, quasistatic = false, varied = false, probed = false;
    for (int number = 0; number < 100 && !(inextensibility && quasistatic && varied && probed); ++number) {
        const StressProblem problem = draw_problem(suite.draw, number);
        const bool is_quasistatic = problem.prior == PriorKind::quasistatic;
        if (is_quasistatic && problem.mu_varies == varied && quasistatic && probed) continue;
        expect_same_projection(folder_, suite, number);
        (is_quasistatic ? quasistatic : inextensibility) = true;
        varied = varied || (is_quasistatic && problem.mu_varies);
        probed = probed || problem.check_derivative;
    }
    EXPECT_TRUE(inextensibility && quasistatic && varied && probed);
}

TEST_F(StabilityReplay, WhatNoOutcomeNamesIsRemoved) {
    const StabilityOutcome failed = failed_case("friction 0, on a table");
    std::ofstream(path("stability_replay/of_an_earlier_pass.h5")) << "old";
    remove_other_replays(folder_.string(), {failed});
    EXPECT_TRUE(fs::exists(path(failed.replay)));
    EXPECT_FALSE(fs::exists(path("stability_replay/of_an_earlier_pass.h5")));
    remove_other_replays(folder_.string(), {});
    EXPECT_FALSE(fs::exists(path("stability_replay")));
}

}  // namespace
}  // namespace toile::evaluate
