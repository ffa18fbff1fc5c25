#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "cloth/error.h"
#include "prior/quasistatic.h"
#include "tests/prior/quasistatic_cases.h"
#include "tests/support/allocation_counter.h"

namespace toile::prior::test {
namespace {

Quasistatic prior_of(const ClothMesh& mesh, double mu = 0.1, const QuasistaticOptions& options = {},
                     const QuasistaticStiffness& stiffness = {}) {
    return Quasistatic(QuasistaticModel::from(rest_state(mesh), stiffness, mu), options);
}

void expect_solved(const Quasistatic& prior, const std::vector<double>& predicted, const std::string& name) {
    const QuasistaticSolution solution = projected(prior, predicted);
    const size_t size = 3 * static_cast<size_t>(prior.model().vertex_count);
    for (size_t i = 0; i < solution.report.size(); ++i) {
        EXPECT_EQ(solution.report[i].status, Status::converged) << name << " " << i;
        EXPECT_LE(solution.report[i].residual, prior.options().tolerance) << name << " " << i;
        const double residual =
            quasistatic_residual(prior.model(), sample_of(predicted, size, i), sample_of(solution.position, size, i));
        EXPECT_LE(residual, 1.001 * prior.options().tolerance) << name << " " << i;
        EXPECT_NEAR(residual, solution.report[i].residual, 1e-8 + 1e-3 * residual) << name << " " << i;
    }
}

TEST(Quasistatic, RestStaysAtRest) {
    const ClothMesh mesh = sheet(7, 6);
    const QuasistaticSolution solution = projected(prior_of(mesh), at_rest(mesh));
    EXPECT_EQ(solution.report[0].status, Status::converged);
    EXPECT_EQ(solution.report[0].iterations, 0);
    EXPECT_LT(largest_difference(solution.position, at_rest(mesh)), 1e-15);
}

TEST(Quasistatic, NoiseIsSolvedInBatchesAndAlone) {
    const ClothMesh mesh = sheet(12, 11);
    const Quasistatic prior = prior_of(mesh);
    std::vector<std::vector<double>> samples;
    for (unsigned seed = 1; seed <= 11; ++seed) samples.push_back(noisy(draped(mesh), 0.001 * seed, seed));
    expect_solved(prior, joined(samples), "batch");
    expect_solved(prior, samples[5], "alone");
}

TEST(Quasistatic, TheResidualIsTheEnergysGradient) {
    const ClothMesh mesh = sheet(4, 4);
    const QuasistaticModel model = QuasistaticModel::from(rest_state(mesh));
    const std::vector<double> predicted = noisy(draped(mesh), 0.004, 3), at = noisy(draped(mesh), 0.002, 4);
    const Eigen::Map<const Eigen::VectorXd> r_hat(predicted.data(), 48), r(at.data(), 48);
    const auto largest = [&](const Eigen::VectorXd& x) {
        double most = 0.0;
        for (int i = 0; i < 48; ++i) {
            Eigen::VectorXd forward = x, backward = x;
            forward[i] += 1e-6;
            backward[i] -= 1e-6;
            most = std::max(
                most, std::abs(dense_energy(model, r_hat, forward) - dense_energy(model, r_hat, backward)) / 2e-6);
        }
        return most;
    };
    const double reference =
        model.edge_stiffness.dot(model.edge_rest_length) / static_cast<double>(model.edge_spring.rows());
    EXPECT_NEAR(quasistatic_residual(model, predicted, at) * std::max(largest(r_hat), reference) / largest(r), 1.0,
                1e-6);
}

TEST(Quasistatic, BothMethodsFindTheSameMinimum) {
    const ClothMesh mesh = sheet(9, 8);
    const std::vector<double> predicted = noisy(draped(mesh), 0.002);
    QuasistaticOptions tight;
    tight.tolerance = 1e-10;
    QuasistaticOptions paper = tight;
    paper.method = QuasistaticOptions::Method::newton_cg;
    const QuasistaticSolution fast = projected(prior_of(mesh, 0.1, tight), predicted);
    const QuasistaticSolution reference = projected(prior_of(mesh, 0.1, paper), predicted);
    EXPECT_EQ(reference.report[0].status, Status::converged);
    EXPECT_EQ(fast.report[0].status, Status::converged);
    EXPECT_LT(largest_difference(fast.position, reference.position), 1e-9);
}

std::vector<std::vector<double>> extremes(const ClothMesh& mesh) {
    const std::vector<double> truth = draped(mesh), noise = noisy(truth, 0.002);
    std::vector<double> point(truth.size(), 0.0), line = truth, plane = truth, mirrored = noise, inverted = truth,
                                                  shrunk = truth, far = noise, distant = noise, shuffled = truth;
    for (size_t i = 0; i < truth.size(); i += 3) {
        line[i] = line[i + 2] = plane[i + 2] = 0.0;
        mirrored[i] = -mirrored[i];
    }
    for (size_t i = 0; i < truth.size(); ++i) {
        inverted[i] = -truth[i];
        shrunk[i] *= 0.005;
        distant[i] += 1000.0;
    }
    far[4] += 100.0;
    std::vector<size_t> order(truth.size() / 3);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    for (size_t v = 0; v < order.size(); ++v)
        std::copy_n(truth.begin() + static_cast<std::ptrdiff_t>(3 * order[v]), 3,
                    shuffled.begin() + static_cast<std::ptrdiff_t>(3 * v));
    return {truth, noisy(truth, 0.2), point, line, plane, mirrored, inverted, shrunk, far, distant, shuffled};
}

TEST(Quasistatic, AnyFiniteInputEndsInAMinimum) {
    const ClothMesh mesh = sheet(7, 7);
    expect_solved(prior_of(mesh), joined(extremes(mesh)), "extreme");
}

TEST(Quasistatic, AnyMuEndsInAMinimum) {
    const ClothMesh mesh = sheet(6, 6);
    for (double mu : {1e-4, 1e-2, 10.0, 1e4})
        expect_solved(prior_of(mesh, mu), joined(extremes(mesh)), "mu " + std::to_string(mu));
}

TEST(Quasistatic, AnyStiffnessEndsInAMinimum) {
    const ClothMesh mesh = sheet(6, 6);
    const QuasistaticStiffness usual;
    const std::vector<double> predicted = joined({noisy(draped(mesh), 0.005, 1), noisy(draped(mesh), 0.03, 2)});
    for (double factor : {1e-3, 1e3}) {
        QuasistaticStiffness stretch = usual, bending = usual, axial = usual;
        stretch.stretch *= factor;
        bending.bending *= factor;
        axial.axial *= factor;
        expect_solved(prior_of(mesh, 0.1, {}, stretch), predicted, "stretch");
        expect_solved(prior_of(mesh, 0.1, {}, bending), predicted, "bending");
        expect_solved(prior_of(mesh, 0.1, {}, axial), predicted, "axial");
    }
}

TEST(Quasistatic, ACollapsedPointUnfolds) {
    const ClothMesh mesh = sheet(5, 5);
    const QuasistaticSolution solution = projected(prior_of(mesh), std::vector<double>(75, 0.0));
    const QuasistaticModel model = QuasistaticModel::from(rest_state(mesh));
    double mean = 0.0;
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); ++e) {
        const Eigen::Map<const Positions> r(solution.position.data(), 25, 3);
        mean += (r.row(model.edge_spring(e, 0)) - r.row(model.edge_spring(e, 1))).norm() / model.edge_rest_length[e] /
                static_cast<double>(model.edge_spring.rows());
    }
    EXPECT_GT(mean, 0.8);
    EXPECT_GE(quasistatic_residual(model, std::vector<double>(75, 0.0), std::vector<double>(75, 0.0)), 0.4)
        << "a point is not a minimum";
}

TEST(Quasistatic, SolutionsScaleWithTheMesh) {
    const ClothMesh mesh = sheet(8, 7);
    ClothMesh millimetres = mesh, heavy = mesh;
    millimetres.rest_position *= 1000.0;
    heavy.mass = Eigen::VectorXd::LinSpaced(56, 1.0, 2.0);
    std::vector<double> predicted = noisy(draped(mesh), 0.003), scaled = predicted;
    for (double& x : scaled) x *= 1000.0;
    QuasistaticOptions tight;
    tight.tolerance = 1e-10;
    const QuasistaticSolution metres = projected(prior_of(mesh, 0.1, tight), predicted);
    QuasistaticSolution other = projected(prior_of(millimetres, 0.1, tight), scaled);
    for (double& x : other.position) x *= 0.001;
    EXPECT_LT(largest_difference(metres.position, other.position), 1e-9);

    const QuasistaticSolution light = projected(prior_of(heavy, 0.1, tight), predicted);
    heavy.mass *= 1e4;
    EXPECT_LT(largest_difference(light.position, projected(prior_of(heavy, 0.1, tight), predicted).position), 1e-9);
    EXPECT_GT(largest_difference(light.position, metres.position), 1e-5);
}

TEST(Quasistatic, ATranslationMovesTheSolution) {
    const ClothMesh mesh = sheet(8, 7);
    const std::vector<double> predicted = noisy(draped(mesh), 0.003);
    std::vector<double> moved = predicted;
    for (double& x : moved) x += 1000.0;
    const Quasistatic prior = prior_of(mesh);
    const QuasistaticSolution here = projected(prior, predicted);
    QuasistaticSolution there = projected(prior, moved);
    for (double& x : there.position) x -= 1000.0;
    EXPECT_LT(largest_difference(here.position, there.position), 1e-8);
}

TEST(Quasistatic, ASampleThatIsNotFiniteIsRejectedAlone) {
    const ClothMesh mesh = sheet(6, 5);
    const Quasistatic prior = prior_of(mesh);
    std::vector<std::vector<double>> samples;
    for (unsigned seed = 0; seed < 4; ++seed) samples.push_back(noisy(draped(mesh), 0.003, seed));
    const QuasistaticSolution clean = projected(prior, joined(samples));
    samples[1][7] = std::numeric_limits<double>::quiet_NaN();
    samples[2][0] = std::numeric_limits<double>::infinity();
    const QuasistaticSolution solution = projected(prior, joined(samples));
    for (size_t i : {1u, 2u}) {
        EXPECT_EQ(solution.report[i].status, Status::rejected_input);
        EXPECT_TRUE(std::isnan(solution.position[90 * i]) && std::isnan(solution.position[90 * i + 89]));
    }
    for (size_t i : {0u, 3u}) {
        EXPECT_EQ(solution.report[i].status, Status::converged);
        EXPECT_EQ(sample_of(solution.position, 90, i), sample_of(clean.position, 90, i));
    }
}

TEST(Quasistatic, NothingDependsOnThreadsOrOrder) {
    const ClothMesh mesh = sheet(9, 9);
    const Quasistatic prior = prior_of(mesh);
    std::vector<std::vector<double>> samples;
    for (unsigned seed = 0; seed < 19; ++seed)
        samples.push_back(noisy(draped(mesh), 0.001 * (1 + 13 * seed % 19), seed));
    const size_t size = samples[0].size();
    const QuasistaticSolution one = projected(prior, joined(samples));
    Quasistatic::Workspace two_threads(prior, 2);
    QuasistaticSolution two;
    prior.project(joined(samples), two, two_threads);
    EXPECT_EQ(one.position, two.position);
    std::reverse(samples.begin(), samples.end());
    const QuasistaticSolution reversed = projected(prior, joined(samples));
    for (size_t i = 0; i < samples.size(); ++i)
        EXPECT_EQ(sample_of(one.position, size, i), sample_of(reversed.position, size, samples.size() - 1 - i));
}

TEST(Quasistatic, AWarmStartTakesFewerSteps) {
    const ClothMesh mesh = sheet(9, 9);
    const Quasistatic prior = prior_of(mesh);
    Quasistatic::Workspace workspace(prior);
    QuasistaticSolution solution;
    const std::vector<double> predicted = joined({noisy(draped(mesh), 0.004, 1), noisy(draped(mesh), 0.004, 2)});
    prior.project(predicted, solution, workspace);
    const int cold = solution.report[0].iterations;
    prior.project(predicted, solution, workspace, true);
    EXPECT_EQ(solution.report[0].iterations, 0);
    prior.project(noisy(predicted, 1e-5), solution, workspace, true);
    EXPECT_LT(solution.report[0].iterations, cold);
    EXPECT_EQ(solution.report[0].status, Status::converged);
    solution.position.pop_back();
    EXPECT_THROW(prior.project(predicted, solution, workspace, true), Error);
}

TEST(Quasistatic, TheHotLoopDoesNotAllocate) {
    const ClothMesh mesh = sheet(8, 8);
    const Quasistatic prior = prior_of(mesh);
    Quasistatic::Workspace workspace(prior);
    QuasistaticSolution solution;
    QuasistaticGradient gradient;
    for (const std::vector<double>& predicted :
         {joined({noisy(draped(mesh), 0.004, 1), noisy(draped(mesh), 0.004, 2)}), noisy(draped(mesh), 0.004, 3)}) {
        prior.project(predicted, solution, workspace);
        prior.backward(predicted, solution, predicted, gradient, workspace);
        const long before = allocation_count();
        prior.project(predicted, solution, workspace);
        prior.backward(predicted, solution, predicted, gradient, workspace);
        EXPECT_EQ(allocation_count(), before);
    }
}

TEST(Quasistatic, TheBudgetOfIterationsIsKept) {
    const ClothMesh mesh = sheet(9, 9);
    QuasistaticOptions options;
    options.max_iterations = 1;
    const QuasistaticSolution solution = projected(prior_of(mesh, 0.1, options), noisy(draped(mesh), 0.01));
    EXPECT_EQ(solution.report[0].status, Status::accuracy_not_reached);
    EXPECT_GT(solution.report[0].residual, options.tolerance);
}

TEST(Quasistatic, MuPullsToThePrediction) {
    const ClothMesh mesh = sheet(10, 10);
    const std::vector<double> truth = draped(mesh), predicted = noisy(truth, 0.002);
    const auto error = [&](double mu) {
        double sum = 0.0;
        const QuasistaticSolution solution = projected(prior_of(mesh, mu), predicted);
        for (size_t i = 0; i < truth.size(); ++i) sum += std::pow(solution.position[i] - truth[i], 2);
        return sum;
    };
    const double best = error(0.1);
    EXPECT_LT(best, 0.8 * error(1.0));
    EXPECT_LT(best, 0.8 * error(1e-3));
    EXPECT_LT(error(1e-3), error(1e-4));
    EXPECT_LT(error(1.0), error(1e3));
}

TEST(Quasistatic, MuCanBeSetAnew) {
    const ClothMesh mesh = sheet(6, 6);
    const std::vector<double> predicted = noisy(draped(mesh), 0.003);
    Quasistatic prior = prior_of(mesh, 1.0);
    prior.set_mu(Eigen::VectorXd::Constant(36, 0.1));
    EXPECT_EQ(projected(prior, predicted).position, projected(prior_of(mesh, 0.1), predicted).position);
    EXPECT_THROW(prior.set_mu(Eigen::VectorXd::Zero(36)), Error);
}

TEST(Quasistatic, OddMeshesAreWelcome) {
    ClothMesh mesh = sheet(5, 4);
    mesh.rest_position.conservativeResize(22, 3);  // two vertices in no triangle
    mesh.rest_position.row(20) << 1.0, 0.0, 0.0;
    mesh.rest_position.row(21) << 1.0, 0.5, 0.0;
    mesh.triangle.conservativeResize(mesh.triangle.rows() + 1, 3);
    mesh.triangle.bottomRows(1) << 0, 1, 20;  // a third triangle at an edge
    const Quasistatic prior = prior_of(mesh);
    const std::vector<double> predicted = joined({noisy(at_rest(mesh), 0.003, 1), noisy(at_rest(mesh), 0.003, 2)});
    expect_solved(prior, predicted, "odd");
    const QuasistaticSolution solution = projected(prior, predicted);
    EXPECT_NEAR(solution.position[63], predicted[63], 1e-12) << "a loose vertex stays where it was predicted";
}

TEST(Quasistatic, WhatMakesNoSenseIsRefused) {
    const RestState rest = rest_state(sheet(4, 4));
    EXPECT_THROW(QuasistaticModel::from(rest, {}, 0.0), Error);
    EXPECT_THROW(QuasistaticModel::from(rest, {.stretch = -1.0}), Error);
    const QuasistaticModel model = QuasistaticModel::from(rest);
    EXPECT_NO_THROW(Quasistatic{model});
    QuasistaticModel wrong = model;
    wrong.edge_spring(2, 1) = 16;
    EXPECT_THROW(Quasistatic{wrong}, Error);
    wrong = model;
    wrong.target_stiffness[3] = 0.0;
    EXPECT_THROW(Quasistatic{wrong}, Error);
    wrong = model;
    wrong.bending_rest_length[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Quasistatic{wrong}, Error);
    QuasistaticOptions options;
    options.tolerance = 1.0;
    EXPECT_THROW(Quasistatic(model, options), Error);
    const Quasistatic prior(model), another(model);
    Quasistatic::Workspace workspace(prior);
    QuasistaticSolution solution;
    EXPECT_THROW(prior.project(std::vector<double>(47), solution, workspace), Error);
    EXPECT_THROW(another.project(std::vector<double>(48), solution, workspace), Error);
}

}  // namespace
}  // namespace toile::prior::test
