#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "cloth/error.h"
#include "prior/inextensibility.h"
#include "tests/prior/inextensible_cases.h"
#include "tests/support/allocation_counter.h"

namespace toile::prior::test {
namespace {

using Method = InextensibilityOptions::Method;

InextensibilitySolution solve(const InextensibilityModel& model, const std::vector<double>& predicted,
                              const InextensibilityOptions& options = {}, int threads = 1) {
    const Inextensibility prior(model, options);
    Inextensibility::Workspace workspace(prior, threads);
    InextensibilitySolution solution;
    prior.project(predicted, solution, workspace);
    return solution;
}

/// Samples one after the other.
std::vector<double> batch(const std::vector<std::vector<double>>& samples) {
    std::vector<double> all;
    for (const auto& sample : samples) all.insert(all.end(), sample.begin(), sample.end());
    return all;
}

std::vector<double> sample_of(const std::vector<double>& all, int sample, std::size_t size) {
    return {all.begin() + sample * size, all.begin() + (sample + 1) * size};
}

void expect_solved(const InextensibilityModel& model, const std::vector<double>& predicted,
                   const InextensibilitySolution& solution, double tolerance, const std::string& what) {
    const std::size_t positions = 3 * model.vertex_count, edges = model.edge.rows();
    for (std::size_t s = 0; s < solution.report.size(); ++s) {
        const Report& report = solution.report[s];
        EXPECT_EQ(report.status, Status::converged) << what << ", sample " << s << ", residual " << report.residual;
        const double residual =
            dense_residual(model, sample_of(predicted, s, positions), sample_of(solution.position, s, positions),
                           sample_of(solution.multiplier, s, edges));
        EXPECT_LE(residual, tolerance * 1.001) << what << ", sample " << s;
    }
}

TEST(Inextensibility, PullsTwoStretchedVerticesTogetherInProportionToTheirMasses) {
    InextensibilityModel model;
    model.vertex_count = 2;
    model.edge.resize(1, 2);
    model.edge << 0, 1;
    model.edge_max_length = Eigen::VectorXd::Constant(1, 1.0);
    model.target_stiffness = Eigen::Vector2d(1.0, 3.0);
    const InextensibilitySolution solution = solve(model, {0, 0, 0, 2, 0, 0});
    EXPECT_NEAR(solution.position[0], 0.75, 1e-6);
    EXPECT_NEAR(solution.position[3], 1.75, 1e-6);
    EXPECT_NEAR(solution.multiplier[0], 0.75, 1e-5);
}

TEST(Inextensibility, LeavesAFeasiblePredictionAsItIs) {
    const InextensibleCase patch_case = patch(5, 4);
    std::vector<double> predicted = patch_case.at_rest();
    for (double& x : predicted) x *= 0.9;
    const InextensibilitySolution solution = solve(patch_case.model, predicted);
    EXPECT_EQ(solution.position, predicted);
    EXPECT_EQ(solution.report[0].iterations, 0);
    EXPECT_EQ(solution.report[0].status, Status::converged);
}

/// What any finite input may look like; each once alone and all of them in one batch.
std::vector<std::pair<std::string, std::vector<double>>> hard_predictions(const InextensibleCase& c) {
    const std::vector<double> rest = c.at_rest();
    const std::size_t size = rest.size();
    const auto made = [&](auto&& change) {
        std::vector<double> p = rest;
        for (std::size_t i = 0; i < size; ++i) p[i] = change(i, rest[i]);
        return p;
    };
    std::vector<std::pair<std::string, std::vector<double>>> all;
    all.emplace_back("collapsed to a point", std::vector<double>(size, 0.3));
    all.emplace_back("collapsed to a line", made([](std::size_t i, double x) { return i % 3 == 0 ? 3 * x : 0.0; }));
    all.emplace_back("mirrored", with_noise(made([](std::size_t i, double x) { return i % 3 == 0 ? -x : x; }), 0.01));
    std::vector<double> shuffled = rest;
    for (std::size_t v = 0; v < size / 3; ++v)
        std::swap_ranges(&shuffled[3 * v], &shuffled[3 * v] + 3, &shuffled[3 * ((v * 7 + 3) % (size / 3))]);
    all.emplace_back("shuffled", shuffled);
    all.emplace_back("shrunk to a millimetre", made([](std::size_t, double x) { return 0.01 * x; }));
    all.emplace_back("noise of 20 cm", with_noise(rest, 0.2));
    std::vector<double> far = with_noise(rest, 0.002);
    far[3] = 100.0;
    all.emplace_back("one vertex 100 m away", far);
    all.emplace_back("a kilometre off", with_noise(made([](std::size_t, double x) { return x + 1000.0; }), 0.005));
    all.emplace_back("twice as large", made([](std::size_t, double x) { return 2 * x; }));
    all.emplace_back("nearly feasible", with_noise(rest, 1e-6));
    all.emplace_back("at rest", rest);
    return all;
}

TEST(Inextensibility, SolvesAnyFiniteInput) {
    const InextensibleCase c = patch(9, 8, 0.02, 0.2);
    std::vector<std::vector<double>> samples;
    for (const auto& [what, predicted] : hard_predictions(c)) {
        expect_solved(c.model, predicted, solve(c.model, predicted), 1e-6, what);
        samples.push_back(predicted);
    }
    const std::vector<double> all = batch(samples);
    expect_solved(c.model, all, solve(c.model, all), 1e-6, "all in one batch");
}

TEST(Inextensibility, KeepsTightTolerances) {
    const InextensibleCase c = patch(7, 6, 0.02, 0.2);
    std::vector<std::vector<double>> samples;
    for (unsigned s = 0; s < 9; ++s) samples.push_back(with_noise(c.at_rest(), 0.001 * (1 + s), s));
    const std::vector<double> all = batch(samples);
    for (double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
        InextensibilityOptions options;
        options.tolerance = tolerance;
        expect_solved(c.model, all, solve(c.model, all, options), tolerance, std::to_string(tolerance));
    }
}

TEST(Inextensibility, AgreesWithTheConeProgram) {
    const InextensibleCase c = patch(8, 7, 0.02, 0.2);
    std::vector<std::vector<double>> samples;
    for (unsigned s = 0; s < 5; ++s) samples.push_back(with_noise(c.at_rest(), 0.004 * (1 + s), s));
    const std::vector<double> all = batch(samples);
    InextensibilityOptions options;
    options.tolerance = 1e-9;
    const InextensibilitySolution fast = solve(c.model, all, options);
    options.method = Method::cone;
    const InextensibilitySolution cone = solve(c.model, all, options);
    expect_solved(c.model, all, fast, 1e-9, "interior point");
    expect_solved(c.model, all, cone, 1e-9, "cone");
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_NEAR(fast.position[i], cone.position[i], 0.02 * 1e-6);
}

TEST(Inextensibility, DoesNotDependOnUnitsOrWeight) {
    const InextensibleCase c = patch(8, 7, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(c.at_rest(), 0.005);
    const InextensibilitySolution metres = solve(c.model, predicted);
    InextensibleCase scaled = c;
    scaled.model.edge_max_length *= 1000;
    scaled.model.target_stiffness *= 1e-3;
    std::vector<double> millimetres = predicted;
    for (double& x : millimetres) x *= 1000;
    const InextensibilitySolution other = solve(scaled.model, millimetres);
    for (std::size_t i = 0; i < predicted.size(); ++i)
        ASSERT_NEAR(other.position[i], 1000 * metres.position[i], 1e-9 * 1000);
    EXPECT_EQ(other.report[0].iterations, metres.report[0].iterations);
}

TEST(Inextensibility, RejectsASampleThatIsNotFiniteAndSolvesTheOthersTheSame) {
    const InextensibleCase c = patch(6, 5, 0.02, 0.2);
    const std::size_t size = c.at_rest().size(), edges = c.model.edge.rows();
    std::vector<std::vector<double>> samples;
    for (unsigned s = 0; s < 4; ++s) samples.push_back(with_noise(c.at_rest(), 0.01, s));
    const InextensibilitySolution good = solve(c.model, batch(samples));
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        samples[1] = c.at_rest();
        samples[1][5] = bad;
        const InextensibilitySolution got = solve(c.model, batch(samples));
        EXPECT_EQ(got.report[1].status, Status::rejected_input);
        EXPECT_TRUE(std::isnan(got.position[size])) << got.position[size];
        EXPECT_TRUE(std::isnan(got.multiplier[edges]));
        for (int s : {0, 2, 3}) {
            EXPECT_EQ(got.report[s].status, Status::converged);
            EXPECT_EQ(sample_of(got.position, s, size), sample_of(good.position, s, size));
        }
    }
}

TEST(Inextensibility, GivesTheSameBytesWhateverTheBatchTheOrderAndTheThreads) {
    const InextensibleCase c = patch(6, 5, 0.02, 0.2);
    const std::size_t size = c.at_rest().size();
    std::vector<std::vector<double>> samples;
    for (unsigned s = 0; s < 19; ++s) samples.push_back(with_noise(c.at_rest(), 0.001 * (1 + s), s));
    const InextensibilitySolution one = solve(c.model, batch(samples));
    EXPECT_EQ(solve(c.model, batch(samples), {}, 2).position, one.position);
    std::vector<std::vector<double>> backwards(samples.rbegin(), samples.rend());
    const InextensibilitySolution other = solve(c.model, batch(backwards));
    for (int s = 0; s < 19; ++s)
        ASSERT_EQ(sample_of(other.position, 18 - s, size), sample_of(one.position, s, size)) << s;
    const InextensibilitySolution pair = solve(c.model, batch({samples[7], samples[2]}));
    EXPECT_EQ(sample_of(pair.position, 0, size), sample_of(one.position, 7, size));
}

TEST(Inextensibility, ASampleAloneGivesTheSameAnswerToItsTolerance) {
    const InextensibleCase c = patch(9, 8, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(c.at_rest(), 0.01);
    InextensibilityOptions options;
    options.tolerance = 1e-9;
    const InextensibilitySolution alone = solve(c.model, predicted, options);
    const InextensibilitySolution both = solve(c.model, batch({predicted, predicted}), options);
    for (std::size_t i = 0; i < predicted.size(); ++i) ASSERT_NEAR(alone.position[i], both.position[i], 1e-8 * 0.02);
}

TEST(Inextensibility, StartsFromAnEarlierSolution) {
    const InextensibleCase c = patch(12, 11, 0.02, 0.2);
    std::vector<std::vector<double>> samples, later;
    for (unsigned s = 0; s < 3; ++s) {
        samples.push_back(with_noise(c.at_rest(), 0.01, s));
        later.push_back(with_noise(samples.back(), 1e-5, 10 + s));
    }
    const Inextensibility prior(c.model);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    prior.project(batch(samples), solution, workspace);
    const int cold = solution.report[0].iterations;
    prior.project(batch(samples), solution, workspace, true);
    EXPECT_EQ(solution.report[0].iterations, 0) << "the same predictions again";
    expect_solved(c.model, batch(samples), solution, 1e-6, "again");
    prior.project(batch(later), solution, workspace, true);
    EXPECT_LT(solution.report[0].iterations, cold);
    expect_solved(c.model, batch(later), solution, 1e-6, "later");
    solution.report.pop_back();
    EXPECT_THROW(prior.project(batch(samples), solution, workspace, true), Error);
}

TEST(Inextensibility, AllocatesNothingOnceItsWorkspaceIsFull) {
    const InextensibleCase c = patch(6, 5, 0.02, 0.2);
    const std::vector<double> eight = batch(std::vector<std::vector<double>>(8, with_noise(c.at_rest(), 0.01)));
    const Inextensibility prior(c.model);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    InextensibilityGradient gradient;
    prior.project(eight, solution, workspace);
    prior.backward(solution, eight, gradient, workspace);
    const long before = allocation_count();
    for (int repeat = 0; repeat < 3; ++repeat) prior.project(eight, solution, workspace);
    const long project = allocation_count() - before;
    for (int repeat = 0; repeat < 3; ++repeat) prior.backward(solution, eight, gradient, workspace);
    const long backward = allocation_count() - before - project;
    // A handful a call, for handing work to threads; iterations, edges and samples allocate nothing.
    EXPECT_LE(project, 3 * 8);
    EXPECT_LE(backward, 3 * 8);
}

TEST(Inextensibility, TakesIsolatedVerticesAndSeveralComponents) {
    InextensibleCase c = patch(4, 3, 0.02, 0.2);
    InextensibilityModel model = c.model;
    const int more = 12 + 2;
    model.vertex_count = 2 * 12 + 2;
    model.edge.conservativeResize(2 * c.model.edge.rows(), 2);
    model.edge.bottomRows(c.model.edge.rows()) = c.model.edge.array() + more;
    model.edge_max_length = c.model.edge_max_length.replicate(2, 1).eval();
    model.target_stiffness = Eigen::VectorXd::Ones(model.vertex_count);
    std::vector<double> predicted = with_noise(c.at_rest(), 0.01);
    const std::vector<double> again = predicted;
    predicted.insert(predicted.end(), {5.0, 5.0, 5.0, -7.0, 0.0, 1.0});
    predicted.insert(predicted.end(), again.begin(), again.end());
    const InextensibilitySolution solution = solve(model, predicted);
    expect_solved(model, predicted, solution, 1e-6, "components");
    for (int i = 36; i < 42; ++i) EXPECT_NEAR(solution.position[i], predicted[i], 1e-12);
}

TEST(Inextensibility, TakesNewLimits) {
    const InextensibleCase c = patch(6, 5, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(c.at_rest(), 0.01);
    Inextensibility prior(c.model);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    prior.project(predicted, solution, workspace);
    prior.set_edge_max_length(1.1 * c.model.edge_max_length);
    prior.project(predicted, solution, workspace);
    InextensibilityModel wider = c.model;
    wider.edge_max_length *= 1.1;
    expect_solved(wider, predicted, solution, 1e-6, "wider");
    EXPECT_THROW(prior.set_edge_max_length(Eigen::VectorXd::Zero(c.model.edge.rows())), Error);
}

TEST(Inextensibility, RefusesModelsAndOptionsThatMakeNoSense) {
    const InextensibilityModel good = patch(3, 3).model;
    EXPECT_NO_THROW(Inextensibility{good});
    const auto refused = [&](auto&& spoil) {
        InextensibilityModel model = good;
        spoil(model);
        EXPECT_THROW(Inextensibility{model}, Error);
    };
    refused([](InextensibilityModel& m) { m.edge(0, 1) = 9; });
    refused([](InextensibilityModel& m) { m.edge(0, 1) = m.edge(0, 0); });
    refused([](InextensibilityModel& m) { m.edge_max_length[2] = 0; });
    refused([](InextensibilityModel& m) { m.edge_max_length[2] = std::numeric_limits<double>::quiet_NaN(); });
    refused([](InextensibilityModel& m) { m.target_stiffness[1] = 0; });
    refused([](InextensibilityModel& m) { m.target_stiffness.conservativeResize(4); });
    refused([](InextensibilityModel& m) { m.vertex_count = 0; });
    const auto refused_options = [&](auto&& spoil) {
        InextensibilityOptions options;
        spoil(options);
        EXPECT_THROW(Inextensibility(good, options), Error);
    };
    refused_options([](InextensibilityOptions& o) { o.tolerance = 0; });
    refused_options([](InextensibilityOptions& o) { o.tolerance = 0.5; });
    refused_options([](InextensibilityOptions& o) { o.max_iterations = 0; });
    const Inextensibility prior(good);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    EXPECT_THROW(prior.project(std::vector<double>(26, 0.0), solution, workspace), Error);
    EXPECT_THROW(Inextensibility::Workspace(prior, 0), Error);
}

TEST(Inextensibility, SaysWhenItsBudgetEndsFirst) {
    const InextensibleCase c = patch(9, 8, 0.02, 0.2);
    const std::vector<double> predicted = with_noise(c.at_rest(), 0.01);
    InextensibilityOptions options;
    options.max_iterations = 1;
    options.tolerance = 1e-9;
    const InextensibilitySolution solution = solve(c.model, predicted, options);
    EXPECT_EQ(solution.report[0].status, Status::accuracy_not_reached);
    EXPECT_GT(solution.report[0].residual, 1e-9);
    EXPECT_TRUE(std::isfinite(solution.position[0]));
}

TEST(Inextensibility, ProjectsOneSampleOfAMeshInOneCall) {
    ClothMesh mesh;
    mesh.rest_position.resize(3, 3);
    mesh.rest_position << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    mesh.triangle.resize(1, 3);
    mesh.triangle << 0, 1, 2;
    Positions predicted = 1.5 * mesh.rest_position;
    const InextensibilitySolution solution = project_inextensible(mesh, predicted, 0.1);
    const InextensibilityModel model = InextensibilityModel::from(rest_state(mesh), 0.1);
    expect_solved(model, {predicted.data(), predicted.data() + 9}, solution, 1e-6, "triangle");
    EXPECT_THROW(InextensibilityModel::from(rest_state(mesh), -1.0), Error);
}

}  // namespace
}  // namespace toile::prior::test
