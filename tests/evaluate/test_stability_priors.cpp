#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "evaluate/stability_priors.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

const auto all_names = [](const std::string&) { return true; };

StabilityOptions quick_options(const std::string& prior) {
    StabilityOptions options;
    options.solver = {prior};
    options.quick = true;
    options.priors.problems = 8;
    return options;
}

TEST(StabilityPriors, ChoosesByPriorNameAndSize) {
    PriorSuite suite;
    suite.problems = 100;
    const std::vector<int> all = chosen_problems(suite, PriorKind::quasistatic, StressRoute::own, false, "");
    EXPECT_EQ(all.size(), 50u) << "half of the problems";
    const std::vector<int> quick = chosen_problems(suite, PriorKind::quasistatic, StressRoute::own, true, "");
    EXPECT_LT(quick.size(), 21u);
    EXPECT_GT(quick.size(), 5u);
    for (const int number : chosen_problems(suite, PriorKind::quasistatic, StressRoute::own, false, ": torn,")) {
        const StressProblem problem = draw_problem(suite.draw, number);
        EXPECT_TRUE(std::count(problem.kind.begin(), problem.kind.end(), PredictionKind::torn)) << number;
    }
    suite.draw.huge_every = 2;
    EXPECT_LT(chosen_problems(suite, PriorKind::quasistatic, StressRoute::paper, false, "").size(), 50u);
}

TEST(StabilityPriors, ARowForEachSampleWithItsFigures) {
    PriorSuite suite;
    suite.problems = 100;
    const StressProblem problem = draw_problem(suite.draw, 3);
    const auto outcomes = run_prior_problem(suite, 3, StressRoute::own, all_names, "");
    ASSERT_EQ(static_cast<int>(outcomes.size()), problem.sample_count());
    std::set<std::string> names;
    for (const StabilityOutcome& one : outcomes) {
        names.insert(one.name);
        EXPECT_EQ(one.solver, "quasistatic/fast");
        EXPECT_TRUE(one.passed()) << one.status;
        EXPECT_LE(one.residual(), one.prior->tolerance);
        EXPECT_THAT(one.name, HasSubstr("problem 3 of seed 1, sample "));
        EXPECT_THAT(one.name, HasSubstr(one.group));
    }
    EXPECT_EQ(names.size(), outcomes.size()) << "each its own";
}

TEST(StabilityPriors, AShortfallFailsAndAFalseClaimIsNamed) {
    StabilityOutcome one = run_prior_problem({}, 3, StressRoute::own, all_names, "").front();
    one.prior->residual = 2 * one.prior->tolerance;
    EXPECT_FALSE(one.passed());
    EXPECT_TRUE(one.false_claim());
    one.prior->status = prior::Status::accuracy_not_reached;
    EXPECT_FALSE(one.passed());
    EXPECT_FALSE(one.false_claim());
}

TEST(StabilityPriors, TheTableDoesNotDependOnJobsAndHoldsBothRoutes) {
    StabilityOptions options = quick_options("inextensibility");
    const std::vector<StabilityOutcome> one = run_stability(options);
    options.jobs = 2;
    const std::vector<StabilityOutcome> two = run_stability(options);
    ASSERT_EQ(one.size(), two.size());
    std::set<std::string> solvers;
    for (std::size_t k = 0; k < one.size(); ++k) {
        EXPECT_EQ(one[k].name, two[k].name);
        EXPECT_EQ(one[k].residual(), two[k].residual());
        solvers.insert(one[k].solver);
    }
    EXPECT_EQ(solvers, (std::set<std::string>{"inextensibility/cone", "inextensibility/interior_point"}));
}

TEST(StabilityPriors, WhatIsKnownIsNotSolvedAgain) {
    StabilityOptions options = quick_options("quasistatic");
    std::vector<StabilityOutcome> known = run_stability(options);
    const std::size_t rows = known.size();
    known.pop_back();
    for (StabilityOutcome& one : known) one.certificate.seconds = 12345.0;
    options.known = known;
    const std::vector<StabilityOutcome> again = run_stability(options);
    ASSERT_EQ(again.size(), rows);
    EXPECT_NE(again.back().certificate.seconds, 12345.0);
    for (std::size_t k = 0; k + 1 < rows; ++k) EXPECT_EQ(again[k].certificate.seconds, 12345.0);
}

}  // namespace
}  // namespace toile::evaluate
