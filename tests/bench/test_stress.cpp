#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "bench/stress.h"
#include "bench/stress_report.h"

namespace toile::bench {
namespace {

StressDraw small_draw() {
    StressDraw draw;
    draw.seed = 77;
    draw.largest = 60;
    draw.huge_every = 0;
    return draw;
}

TEST(Stress, TenSmallProblemsMeetTheirTolerance) {
    const std::vector<StressOutcome> outcomes = run_stress(small_draw(), 0, 10, 1);
    ASSERT_GE(outcomes.size(), 10u);
    int derivatives = 0;
    for (const StressOutcome& outcome : outcomes) {
        EXPECT_TRUE(outcome.met()) << outcome.failure << " residual " << outcome.residual << "; "
                                   << outcome.description;
        EXPECT_TRUE(outcome.derivative_met()) << outcome.identity_error << "; " << outcome.description;
        derivatives += outcome.derivative_checked;
    }
    EXPECT_GT(derivatives, 0);
}

TEST(Stress, OutcomesDoNotDependOnJobs) {
    const std::vector<StressOutcome> one = run_stress(small_draw(), 10, 6, 1), two = run_stress(small_draw(), 10, 6, 2);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        EXPECT_EQ(one[k].description, two[k].description);
        EXPECT_EQ(one[k].residual, two[k].residual);
        EXPECT_EQ(one[k].iterations, two[k].iterations);
    }
}

TEST(Stress, OneProblemAloneIsTheSameAsInARun) {
    const std::vector<StressOutcome> run = run_stress(small_draw(), 0, 4, 1), alone = run_stress(small_draw(), 3, 1, 1);
    const StressOutcome& last = run.back();
    EXPECT_EQ(last.description, alone.back().description);
    EXPECT_EQ(last.residual, alone.back().residual);
}

StressOutcome good_outcome() {
    StressOutcome outcome;
    outcome.problem = 12;
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
    EXPECT_FALSE(any_false_claim({good}));

    StressOutcome honest = good;
    honest.status = prior::Status::accuracy_not_reached;
    honest.residual = 1e-3;
    EXPECT_FALSE(honest.met());
    EXPECT_FALSE(any_false_claim({good, honest}));

    StressOutcome claim = good;
    claim.residual = 1.1e-6;
    EXPECT_TRUE(any_false_claim({good, claim}));
    claim.residual = std::nan("");
    EXPECT_TRUE(any_false_claim({good, claim}));

    StressOutcome derivative = good;
    derivative.identity_error = 1e-8;
    EXPECT_FALSE(derivative.derivative_met());
    EXPECT_TRUE(any_false_claim({good, derivative}));
    derivative.derivative_claimed = false;
    EXPECT_FALSE(any_false_claim({good, derivative}));
}

TEST(Stress, TheReportNamesWhatFellShort) {
    StressOutcome failed = good_outcome();
    failed.failure = "out of luck";
    std::ostringstream out;
    print_stress(out, {good_outcome(), failed});
    EXPECT_NE(out.str().find("--only 12: failed: out of luck"), std::string::npos) << out.str();
}

}  // namespace
}  // namespace toile::bench
