#include <gtest/gtest.h>

#include "evaluate/case_meshes.h"
#include "evaluate/cloth_quantities.h"
#include "evaluate/prior_methods.h"

namespace toile::evaluate {
namespace {

TEST(PriorMethod, IsNamedByItsSetting) {
    EXPECT_EQ(PriorMethod{}.name, "predicted");
    EXPECT_EQ(PriorMethod::inextensibility(0.0).name, "inextensibility@limit=0");
    EXPECT_EQ(PriorMethod::inextensibility(0.05).name, "inextensibility@limit=0.05");
    EXPECT_EQ(PriorMethod::quasistatic(1e-4, 3).name, "quasistatic@mu=0.0001");
    EXPECT_EQ(PriorMethod::quasistatic(1e3, 3).name, "quasistatic@mu=1000");
    EXPECT_EQ(PriorMethod::quasistatic(0.3, 3, "best").name, "quasistatic@mu=best");
    const PriorMethod vertex = PriorMethod::quasistatic_vertex(Eigen::Vector2d(0.1, 10.0));
    EXPECT_EQ(vertex.name, "quasistatic@mu=vertex");
    EXPECT_NEAR(vertex.setting, 1.0, 1e-12);
}

TEST(NextBatch, NeverLeavesASingleSample) {
    for (int count = 2; count < 60; ++count)
        for (int left = count; left > 0; left -= next_batch(left, 8)) EXPECT_GT(left, 1) << count;
    EXPECT_EQ(next_batch(1, 8), 1);
}

class PriorRuns : public ::testing::Test {
  protected:
    static constexpr int samples = 3;
    void SetUp() override {
        for (int k = 0; k < samples; ++k) {
            Positions x = 1.02 * mesh_.rest_position;
            shake(x, 0.006, 10 + static_cast<std::uint64_t>(k));
            predicted_.insert(predicted_.end(), x.data(), x.data() + x.size());
        }
    }
    QuantityValues judge(const std::vector<double>& position, int k) const {
        const Eigen::Index size = mesh_.rest_position.size();
        const Positions cloth = Eigen::Map<const Positions>(position.data() + k * size, mesh_.rest_position.rows(), 3);
        return judge_.judge(cloth, judge_.target(mesh_.rest_position));
    }
    ClothMesh mesh_ = grid_cloth(even_lines(6, 0.3), even_lines(5, 0.25), 0.0, 0.2);
    ClothJudge judge_{mesh_, 0.05};
    std::vector<double> predicted_;
};

TEST_F(PriorRuns, LeaveThePredictionAlone) {
    PriorRunner runner(mesh_, 1);
    const MethodResult result = runner.run(PriorMethod{}, predicted_);
    EXPECT_EQ(result.position, predicted_);
    EXPECT_TRUE(result.report.empty());
}

TEST_F(PriorRuns, HoldEdgesToTheirLimit) {
    PriorRunner runner(mesh_, 1);
    ASSERT_GT(at(judge(predicted_, 0), Quantity::overstretched_share), 10.0);
    for (const double limit : {0.0, 0.05}) {
        const MethodResult result = runner.run(PriorMethod::inextensibility(limit), predicted_);
        for (int k = 0; k < samples; ++k) {
            EXPECT_EQ(result.report[k].status, prior::Status::converged);
            EXPECT_EQ(at(judge(result.position, k), Quantity::overstretched_share), 0.0);
            EXPECT_NEAR(at(judge(result.position, k), Quantity::largest_stretch), 1 + limit, 1e-5);
        }
    }
}

TEST_F(PriorRuns, ReachTheTruthSomewhereBetweenTheExtremesOfMu) {
    PriorRunner runner(mesh_, 1);
    const auto error = [&](double mu) {
        const auto result = runner.run(PriorMethod::quasistatic(mu, mesh_.vertex_count()), predicted_);
        return at(judge(result.position, 0), Quantity::sqrt_mse);
    };
    const double stiff = error(1e3), middle = error(1.0);
    EXPECT_LT(middle, stiff);
    EXPECT_NEAR(stiff, at(judge(predicted_, 0), Quantity::sqrt_mse), 0.1) << "the prediction itself";
}

TEST_F(PriorRuns, ComeOutTheSameAfterOtherSettings) {
    PriorRunner runner(mesh_, 2);
    const PriorMethod inextensible = PriorMethod::inextensibility(0.02);
    const PriorMethod quasistatic = PriorMethod::quasistatic(0.5, mesh_.vertex_count());
    const std::vector<double> first = runner.run(inextensible, predicted_).position;
    const std::vector<double> second = runner.run(quasistatic, predicted_).position;
    runner.run(PriorMethod::inextensibility(0.0), predicted_);
    runner.run(PriorMethod::quasistatic(10.0, mesh_.vertex_count()), predicted_);
    EXPECT_EQ(runner.run(inextensible, predicted_).position, first);
    EXPECT_EQ(PriorRunner(mesh_, 1).run(quasistatic, predicted_).position, second);
}

}  // namespace
}  // namespace toile::evaluate
