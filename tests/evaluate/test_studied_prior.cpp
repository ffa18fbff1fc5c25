#include <gtest/gtest.h>

#include "evaluate/studied_prior.h"
#include "tests/support/small_problem.h"

namespace toile::evaluate {
namespace {

prior::RestState small_rest(const test::SmallProblem& problem) {
    ClothMesh mesh;
    mesh.rest_position = Eigen::Map<const Positions>(problem.rest.data(), test::vertices, 3);
    mesh.triangle =
        Eigen::Map<const Triangles>(problem.triangle.data(), static_cast<Eigen::Index>(problem.triangle.size() / 3), 3);
    return prior::rest_state(mesh);
}

/// Says that it converged, whatever it is asked; its residual, computed again, tells otherwise.
class Claimant final : public StudiedPrior {
  public:
    Claimant(double residual, double drift) : residual_(residual), drift_(drift) {}
    void project(std::span<const double> predicted, Solved& solved) override {
        solved.position.assign(predicted.begin(), predicted.end());
        solved.report.assign(1, {});
        solved.report[0].status = prior::Status::converged;
    }
    void polish(std::span<const double>, Solved& solved) override {
        for (double& one : solved.position) one += drift_;
    }
    void backward(std::span<const double>, const Solved&, std::span<const double>, Gradient&) override {}
    double residual(std::span<const double>, const Solved&) const override { return residual_; }

  private:
    double residual_, drift_;
};

SolutionMethod claimant(const std::string& name, double residual, double drift = 0.0, bool one_solution = true) {
    return {"prior", name, one_solution,
            [=](const prior::RestState&, double, int) { return std::make_unique<Claimant>(residual, drift); }};
}

TEST(CertifiedReferences, BelieveNoClaim) {
    const test::SmallProblem problem(1);
    const auto reference = certified_references({claimant("liar", 1e-3)}, small_rest(problem), {problem.predicted});
    ASSERT_EQ(reference.size(), 1u);
    EXPECT_FALSE(reference[0].certified);
    EXPECT_EQ(reference[0].residual, 1e-3);
}

TEST(CertifiedReferences, TakeTheNextMethodWhereTheFirstFails) {
    const test::SmallProblem problem(1);
    const auto reference = certified_references({claimant("liar", 1e-3), claimant("honest", 1e-11)},
                                                small_rest(problem), {problem.predicted});
    EXPECT_TRUE(reference[0].certified);
    EXPECT_EQ(reference[0].method, "honest");
}

TEST(CertifiedReferences, AreReachedByEveryPriorOnASmallMesh) {
    const test::SmallProblem problem(2);
    const size_t half = problem.predicted.size() / 2;
    const std::vector<std::vector<double>> predicted{
        {problem.predicted.begin(), problem.predicted.begin() + static_cast<std::ptrdiff_t>(half)},
        {problem.predicted.begin() + static_cast<std::ptrdiff_t>(half), problem.predicted.end()}};
    const prior::RestState rest = small_rest(problem);
    const std::vector<SolutionMethod> methods = solution_methods();
    ASSERT_EQ(methods.size(), 4u);
    std::vector<std::vector<Reference>> all;
    for (const SolutionMethod& method : methods) {
        all.push_back(certified_references({method}, rest, predicted));
        for (const Reference& one : all.back()) EXPECT_TRUE(one.certified) << method.name() << " " << one.residual;
    }
    for (size_t s = 0; s < predicted.size(); ++s)
        EXPECT_LT(cloth_distance(all[0][s].solved.position, all[1][s].solved.position).largest, 1e-8)
            << "both methods of the convex prior come to one place";
}

TEST(MinimumCheck, CountsWhatEndsElsewhere) {
    const test::SmallProblem problem(1);
    const prior::RestState rest = small_rest(problem);
    Reference reference;
    reference.solved.position = problem.predicted;
    StudiedPrior::Solved solved;
    solved.position = problem.predicted;
    solved.report.assign(1, {});
    solved.report[0].status = prior::Status::converged;
    const auto elsewhere = [&](double drift, bool one_solution) {
        MinimumCheck check(claimant("drifts", 0.0, drift, one_solution), rest);
        return check.other_minimum(problem.predicted, solved, reference);
    };
    EXPECT_TRUE(elsewhere(0.01 * test::edge_length, false));
    EXPECT_FALSE(elsewhere(1e-5 * test::edge_length, false)) << "the same place, up to what solving leaves";
    EXPECT_FALSE(elsewhere(0.01 * test::edge_length, true)) << "a convex problem has one minimum";
}

TEST(ClothDistance, IsThatOfVertices) {
    const std::vector<double> a{0, 0, 0, 1, 1, 1}, b{0, 3, 4, 1, 1, 1};
    EXPECT_DOUBLE_EQ(cloth_distance(a, b).largest, 5.0);
    EXPECT_DOUBLE_EQ(cloth_distance(a, b).rms, std::sqrt(25.0 / 2.0));
}

}  // namespace
}  // namespace toile::evaluate
