#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "prior/cone_solver.h"
#include "tests/prior/inextensible_cases.h"

namespace toile::prior::test {
namespace {

struct Projected {
    std::vector<double> position, multiplier;
    Report report;
};

Projected project(const InextensibilityModel& model, const std::vector<double>& predicted, double tolerance = 1e-9) {
    Projected result;
    result.position.resize(predicted.size());
    result.multiplier.resize(static_cast<size_t>(model.edge.rows()));
    InextensibilityOptions options;
    options.tolerance = tolerance;
    result.report = ConeSolver(model).project(predicted, result.position, result.multiplier, options);
    return result;
}

void expect_solved(const InextensibilityModel& model, const std::vector<double>& predicted, const Projected& result,
                   double tolerance = 1e-9) {
    EXPECT_EQ(result.report.status, Status::converged);
    EXPECT_LE(result.report.residual, tolerance);
    EXPECT_LE(dense_residual(model, predicted, result.position, result.multiplier), tolerance * (1 + 1e-6) + 1e-14);
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

TEST(ConeSolver, SharesOneEdgeByStiffness) {
    Positions rest(2, 3);
    rest << 0, 0, 0, 2, 0, 0;
    InextensibleCase edge = case_of(rest, {{0, 1}});
    edge.model.target_stiffness << 1, 3;
    const Projected result = project(edge.model, {0, 0, 0, 4, 0, 0});
    EXPECT_LT(largest_difference(result.position, {1.5, 0, 0, 3.5, 0, 0}), 1e-12);
    EXPECT_NEAR(result.multiplier[0], 1.5, 1e-12);
}

TEST(ConeSolver, PullsAChainTogether) {
    // Five vertices predicted 3 apart on a line, edges of 1: the solution keeps the centre, and each multiplier is what
    // the vertices to its left are displaced by, together.
    Positions rest(5, 3);
    for (int i = 0; i < 5; ++i) rest.row(i) << i, 0, 0;
    const InextensibleCase chain = case_of(rest, {{0, 1}, {1, 2}, {2, 3}, {3, 4}});
    std::vector<double> predicted;
    for (int i = 0; i < 5; ++i) predicted.insert(predicted.end(), {3.0 * i, 1.0, 2.0});
    const Projected result = project(chain.model, predicted);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(result.position[3 * i], 6.0 + (i - 2), 1e-10);
    EXPECT_LT(largest_difference(result.multiplier, {4, 6, 6, 4}), 1e-9);
}

TEST(ConeSolver, SolvesThePapersTriangleOnALine) {
    // Figure 11: all three edges taut on one line; only the sums of multipliers are determined.
    Positions rest(3, 3);
    rest << -1, 0, 0, 0, 0, 0, 1, 0, 0;
    const InextensibleCase triangle = case_of(rest, {{0, 1}, {1, 2}, {0, 2}});
    const std::vector<double> predicted{-2, 0, 0, 0, 0, 0, 2, 0, 0};
    const Projected result = project(triangle.model, predicted);
    expect_solved(triangle.model, predicted, result);
    EXPECT_LT(largest_difference(result.position, {-1, 0, 0, 0, 0, 0, 1, 0, 0}), 1e-9);
    EXPECT_NEAR(result.multiplier[0] + result.multiplier[2], 1.0, 1e-9);
    EXPECT_NEAR(result.multiplier[1] + result.multiplier[2], 1.0, 1e-9);
}

TEST(ConeSolver, LeavesAPredictionThatIsShortEnough) {
    const InextensibleCase cloth = patch(4, 4);
    std::vector<double> predicted = cloth.at_rest();
    for (double& x : predicted) x *= 0.9;
    const Projected result = project(cloth.model, predicted);
    EXPECT_EQ(result.position, predicted);
    EXPECT_EQ(result.multiplier, std::vector<double>(cloth.model.edge.rows(), 0.0));
    EXPECT_EQ(result.report.residual, 0.0);
    const Projected at_limit = project(cloth.model, cloth.at_rest());
    expect_solved(cloth.model, cloth.at_rest(), at_limit);
    EXPECT_EQ(at_limit.position, cloth.at_rest());
}

TEST(ConeSolver, LeavesVerticesThatNothingPulls) {
    Positions rest(6, 3);
    rest << 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 7, 7, 7, 8, 7, 7;
    const InextensibleCase parts = case_of(rest, {{0, 1}, {1, 2}, {0, 2}, {4, 5}});  // vertex 3 has no edge
    std::vector<double> predicted = parts.at_rest();
    predicted[15] = 9.0;  // stretches the second part only
    const Projected result = project(parts.model, predicted);
    expect_solved(parts.model, predicted, result);
    EXPECT_LT(largest_difference({result.position.begin(), result.position.begin() + 12},
                                 {predicted.begin(), predicted.begin() + 12}),
              1e-9);
    EXPECT_NEAR(result.position[12], 7.5, 1e-9);
    EXPECT_NEAR(result.position[15], 8.5, 1e-9);
}

TEST(ConeSolver, ProjectsAProjectionToItself) {
    const InextensibleCase cloth = patch(6, 5, 0.02, 0.2);
    for (double offset : {0.0, 1000.0}) {
        std::vector<double> predicted = with_noise(cloth.at_rest(), 0.01);
        for (double& x : predicted) x += offset;
        const Projected once = project(cloth.model, predicted), twice = project(cloth.model, once.position);
        expect_solved(cloth.model, once.position, twice);
        EXPECT_LT(largest_difference(once.position, twice.position), 1e-10);
    }
}

TEST(ConeSolver, SolvesAnOverstretchThatIsWithinTheTolerance) {
    // Its answer is not to leave the prediction as it is, which would say that no edge carries a force.
    Positions rest(2, 3);
    rest << 0, 0, 0, 1, 0, 0;
    const InextensibleCase edge = case_of(rest, {{0, 1}});
    const Projected result = project(edge.model, {0, 0, 0, 1 + 1e-7, 0, 0}, 1e-6);
    EXPECT_NEAR(result.multiplier[0], 0.5e-7, 1e-13);
    EXPECT_NEAR(result.position[3] - result.position[0], 1.0, 1e-13);
}

TEST(ConeSolver, GivesLooseEdgesNoMultiplier) {
    const InextensibleCase cloth = patch(6, 6, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.005);
    const Projected result = project(cloth.model, predicted);
    expect_solved(cloth.model, predicted, result);
    const auto loose = std::count(result.multiplier.begin(), result.multiplier.end(), 0.0);
    EXPECT_GT(loose, 5);
    EXPECT_LT(loose, cloth.model.edge.rows() - 5);
}

struct Extreme {
    const char* name;
    void (*change)(InextensibilityModel& model, std::vector<double>& predicted);
};

class ConeSolverExtremes : public ::testing::TestWithParam<Extreme> {};

TEST_P(ConeSolverExtremes, EndInTheRightAnswer) {
    for (const InextensibleCase& cloth : {patch(2, 2), patch(5, 4, 0.02, 0.2), patch(8, 7)}) {
        InextensibilityModel model = cloth.model;
        std::vector<double> predicted = cloth.at_rest();
        GetParam().change(model, predicted);
        expect_solved(model, predicted, project(model, predicted, 1e-7), 1e-7);
    }
}

void scale(std::vector<double>& values, double factor) {
    for (double& x : values) x *= factor;
}

const Extreme kExtremes[] = {
    {"point", [](InextensibilityModel&, std::vector<double>& p) { std::fill(p.begin(), p.end(), 0.3); }},
    {"point_but_one",
     [](InextensibilityModel&, std::vector<double>& p) {
         std::fill(p.begin(), p.end(), 0.3);
         p[0] = 1.3;
     }},
    {"line",
     [](InextensibilityModel&, std::vector<double>& p) {
         for (size_t i = 0; i < p.size(); ++i) p[i] = i % 3 == 0 ? 0.37 * static_cast<double>(i * i % 11) : 0.0;
     }},
    {"mirrored",
     [](InextensibilityModel&, std::vector<double>& p) {
         for (size_t i = 0; i < p.size(); i += 3) p[i] *= -1.2;
     }},
    {"shuffled", [](InextensibilityModel&, std::vector<double>& p) { std::rotate(p.begin(), p.begin() + 7, p.end()); }},
    {"one_millimetre", [](InextensibilityModel&, std::vector<double>& p) { scale(p, 0.001); }},
    {"small_noise", [](InextensibilityModel&, std::vector<double>& p) { p = with_noise(p, 1e-5); }},
    {"noise_of_20_cm", [](InextensibilityModel&, std::vector<double>& p) { p = with_noise(p, 0.2); }},
    {"one_vertex_100_m_away", [](InextensibilityModel&, std::vector<double>& p) { p[4] += 100.0; }},
    {"a_kilometre_off",
     [](InextensibilityModel&, std::vector<double>& p) {
         p = with_noise(p, 0.01);
         for (double& x : p) x += 1000.0;
     }},
    {"flat_and_stretched", [](InextensibilityModel&, std::vector<double>& p) { scale(p, 1.3); }},
    {"stretched_along_x",
     [](InextensibilityModel&, std::vector<double>& p) {
         for (size_t i = 0; i < p.size(); i += 3) p[i] *= 1.5;
     }},
    {"stiffness_over_twelve_decades",
     [](InextensibilityModel& m, std::vector<double>& p) {
         p = with_noise(p, 0.02);
         for (int i = 0; i < m.vertex_count; ++i) m.target_stiffness[i] = std::pow(10.0, i % 13 - 6);
     }},
    {"limits_over_eight_decades",
     [](InextensibilityModel& m, std::vector<double>& p) {
         p = with_noise(p, 0.02);
         for (int e = 0; e < m.edge.rows(); ++e) m.edge_max_length[e] *= std::pow(10.0, 2 * (e % 5) - 5);
     }},
};

INSTANTIATE_TEST_SUITE_P(All, ConeSolverExtremes, ::testing::ValuesIn(kExtremes),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(ConeSolver, GivesTheSameInAnyUnits) {
    InextensibleCase cloth = patch(5, 5, 0.02, 0.2);
    std::vector<double> predicted = with_noise(cloth.at_rest(), 0.01);
    const Projected in_metres = project(cloth.model, predicted);
    cloth.model.edge_max_length *= 1000;
    cloth.model.target_stiffness *= 1e6;
    scale(predicted, 1000);
    Projected in_millimetres = project(cloth.model, predicted);
    scale(in_millimetres.position, 1e-3);
    scale(in_millimetres.multiplier, 1e-9);
    EXPECT_LT(largest_difference(in_metres.position, in_millimetres.position), 1e-9);
    EXPECT_LT(largest_difference(in_metres.multiplier, in_millimetres.multiplier), 1e-9);
}

TEST(ConeSolver, RejectsWhatIsNotFinite) {
    const InextensibleCase cloth = patch(3, 3);
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        std::vector<double> predicted = cloth.at_rest();
        predicted[5] = bad;
        const Projected result = project(cloth.model, predicted);
        EXPECT_EQ(result.report.status, Status::rejected_input);
        for (double x : result.position) EXPECT_TRUE(std::isnan(x));
        for (double x : result.multiplier) EXPECT_TRUE(std::isnan(x));
    }
}

TEST(ConeSolver, SaysWhereTheBudgetEnded) {
    const InextensibleCase cloth = patch(5, 5, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(cloth.at_rest(), 0.02);
    std::vector<double> position(predicted.size()), multiplier(cloth.model.edge.rows());
    InextensibilityOptions options;
    options.max_iterations = 3;
    const Report report = ConeSolver(cloth.model).project(predicted, position, multiplier, options);
    EXPECT_EQ(report.status, Status::accuracy_not_reached);
    EXPECT_EQ(report.iterations, 3);
    EXPECT_GT(report.residual, options.tolerance);
    EXPECT_DOUBLE_EQ(report.residual, inextensibility_residual(cloth.model, predicted, position, multiplier));
}

TEST(ConeSolver, GivesTheSameFromEveryThreadAndWorkspace) {
    const InextensibleCase cloth = patch(6, 5, 0.02, 0.2);
    const ConeSolver solver(cloth.model);
    const std::vector<double> first = with_noise(cloth.at_rest(), 0.01, 1), second = with_noise(first, 0.01, 2);
    std::vector<std::vector<double>> position(3, std::vector<double>(first.size()));
    auto solve = [&](int which) {
        ConeSolver::Workspace workspace(solver);
        std::vector<double> multiplier(cloth.model.edge.rows());
        if (which > 0) solver.project(second, position[which], multiplier, {}, workspace);  // leaves nothing behind
        solver.project(first, position[which], multiplier, {}, workspace);
    };
    solve(0);
    std::thread one(solve, 1), two(solve, 2);
    one.join();
    two.join();
    EXPECT_EQ(position[0], position[1]);
    EXPECT_EQ(position[0], position[2]);
}

}  // namespace
}  // namespace toile::prior::test
