#include <gtest/gtest.h>

#include <cmath>

#include "evaluate/stress.h"

namespace toile::evaluate {
namespace {

StressDraw small_draw() {
    StressDraw draw;
    draw.seed = 77;
    draw.largest = 60;
    draw.huge_every = 0;
    return draw;
}

TEST(Stress, TenSmallProblemsMeetTheirTolerance) {
    int derivatives = 0, samples = 0;
    for (int number = 0; number < 10; ++number)
        for (const StressOutcome& outcome : solve_problem(draw_problem(small_draw(), number))) {
            EXPECT_TRUE(outcome.met()) << outcome.failure << " residual " << outcome.residual << "; "
                                       << outcome.description;
            EXPECT_TRUE(outcome.derivative_met()) << outcome.identity_error << "; " << outcome.description;
            derivatives += outcome.derivative_checked;
            ++samples;
        }
    EXPECT_GE(samples, 10);
    EXPECT_GT(derivatives, 0);
}

TEST(Stress, ThePapersRoutesMeetItToo) {
    for (int number = 0; number < 2; ++number) {
        const StressProblem problem = draw_problem(small_draw(), number);
        StressSolution own, paper;
        solve_problem(problem, StressRoute::own, own);
        for (const StressOutcome& outcome : solve_problem(problem, StressRoute::paper, paper))
            EXPECT_TRUE(outcome.met()) << outcome.failure << " residual " << outcome.residual << "; "
                                       << outcome.description;
        ASSERT_EQ(own.position.size(), problem.predicted.size());
        EXPECT_NE(own.position, paper.position) << "another algorithm";
    }
}

TEST(Stress, WhatAPriorThrowsIsAFailure) {
    StressProblem problem = draw_problem(small_draw(), 0);
    problem.mesh.triangle(0, 0) = problem.mesh.vertex_count();
    StressSolution solution;
    for (const StressOutcome& outcome : solve_problem(problem, StressRoute::own, solution)) {
        EXPECT_FALSE(outcome.met());
        EXPECT_FALSE(outcome.finite);
        EXPECT_FALSE(outcome.failure.empty());
    }
    EXPECT_TRUE(solution.position.empty());
}

TEST(Stress, ASampleThatIsNotFiniteHasNotMetItsTolerance) {
    StressProblem problem = draw_problem(small_draw(), 0);
    problem.predicted[0] = std::nan("");
    const StressOutcome first = solve_problem(problem).front();
    EXPECT_FALSE(first.finite);
    EXPECT_FALSE(first.met());
    EXPECT_FALSE(first.false_claim()) << "and does not claim to";
}

StressOutcome good_outcome() {
    StressOutcome outcome;
    outcome.problem = 12;
    outcome.finite = true;
    outcome.status = prior::Status::converged;
    outcome.tolerance = 1e-6;
    outcome.residual = 5e-7;
    outcome.derivative_checked = outcome.derivative_claimed = true;
    outcome.identity_error = 1e-12;
    return outcome;
}

TEST(Stress, TellsShortfallsFromFalseClaims) {
    const StressOutcome good = good_outcome();
    EXPECT_TRUE(good.met() && good.derivative_met());
    EXPECT_FALSE(good.false_claim() || good.false_derivative());

    StressOutcome honest = good;
    honest.status = prior::Status::accuracy_not_reached;
    honest.residual = 1e-3;
    EXPECT_FALSE(honest.met());
    EXPECT_FALSE(honest.false_claim());

    StressOutcome claim = good;
    claim.residual = 1.1e-6;
    EXPECT_TRUE(claim.false_claim());
    claim.residual = std::nan("");
    EXPECT_TRUE(claim.false_claim());

    StressOutcome derivative = good;
    derivative.identity_error = 1e-8;
    EXPECT_FALSE(derivative.derivative_met());
    EXPECT_TRUE(derivative.false_derivative());
    derivative.derivative_claimed = false;
    EXPECT_FALSE(derivative.false_derivative());
}

}  // namespace
}  // namespace toile::evaluate
