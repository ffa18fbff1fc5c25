#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "files/projection_file.h"
#include "generate/ordered_work.h"
#include "generate/project.h"
#include "generate/validate_projection.h"
#include "tests/support/small_problem.h"

namespace toile::generate {
namespace {

using test::SmallProblem;

class ProjectTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("toile_project_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        options_.problem = (folder_ / "p.h5").string();
        options_.out = (folder_ / "o.h5").string();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    ProjectSummary run(Prior prior, const std::vector<std::string>& keys = {}) const {
        return project(read_project_config(prior, keys), options_);
    }

    std::filesystem::path folder_;
    ProjectOptions options_;
};

TEST_F(ProjectTest, CountsWhatItDid) {
    SmallProblem(3).write(options_.problem);
    options_.gradient = true;
    for (const Prior prior : {Prior::inextensibility, Prior::quasistatic}) {
        const ProjectSummary summary = run(prior);
        EXPECT_EQ(summary.samples, 3);
        EXPECT_EQ(summary.converged, 3);
        EXPECT_TRUE(summary.failed.empty());
        EXPECT_EQ(summary.vertices, test::vertices);
        EXPECT_EQ(summary.edges, 43);
        EXPECT_GT(summary.worst_residual, 0);
        EXPECT_LE(summary.worst_residual, 1e-6);
        EXPECT_GT(summary.forward, 0);
        EXPECT_GT(summary.backward, 0);
        EXPECT_TRUE(validate_projection(options_.out).defect.empty());
    }
}

TEST_F(ProjectTest, SaysHowFarItIs) {
    SmallProblem(130).write(options_.problem);
    std::vector<int> done;
    options_.progress = [&](const Progress& progress) {
        EXPECT_EQ(progress.total, 130);
        done.push_back(progress.done);
    };
    run(Prior::inextensibility);
    EXPECT_EQ(done, (std::vector<int>{0, 64, 128, 130}));
}

TEST_F(ProjectTest, NeverLeavesASingleSampleForLast) {
    SmallProblem(65).write(options_.problem);
    std::vector<int> done;
    options_.progress = [&](const Progress& progress) { done.push_back(progress.done); };
    run(Prior::inextensibility);
    EXPECT_EQ(done, (std::vector<int>{0, 65}));
}

TEST_F(ProjectTest, AnInterruptLeavesNothing) {
    SmallProblem(130).write(options_.problem);
    std::atomic<bool> interrupted{false};
    options_.interrupted = &interrupted;
    options_.progress = [&](const Progress& progress) { interrupted = progress.done > 0; };
    EXPECT_THROW(run(Prior::quasistatic), Interrupted);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "the problem alone";
}

TEST_F(ProjectTest, TheModelInTheFileIsTheOneThatWasSolved) {
    SmallProblem problem(2);
    problem.write(options_.problem);
    run(Prior::inextensibility, {"stretch_limit=0.25"});
    const files::ProjectionReader reader(options_.out);
    ASSERT_TRUE(reader.header().limits);
    EXPECT_EQ(reader.header().limits->edge.row(0), Eigen::RowVector2i(0, 1));
    EXPECT_NEAR(reader.header().limits->edge_max_length[0], 1.25 * test::edge_length, 1e-15);
    EXPECT_EQ(reader.read(0, 2).predicted, problem.predicted);
}

TEST_F(ProjectTest, RefusesAGradientWithoutATarget) {
    SmallProblem(1).write(options_.problem, false);
    options_.gradient = true;
    EXPECT_THROW(run(Prior::inextensibility), Error);
    EXPECT_FALSE(std::filesystem::exists(options_.out));
}

TEST_F(ProjectTest, AProblemIsValidUnlessASampleIsNot) {
    SmallProblem problem(3);
    problem.write(options_.problem);
    EXPECT_TRUE(validate_problem(options_.problem).defect.empty());
    problem.predicted[test::width] = std::nan("");
    problem.write(options_.problem);
    const Validation validation = validate_problem(options_.problem);
    EXPECT_THAT(validation.defect, testing::ElementsAre("/samples/predicted[1]: is not finite"));
    EXPECT_EQ(validation.accepted, 2);
}

}  // namespace
}  // namespace toile::generate
