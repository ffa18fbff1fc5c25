#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "evaluate/stability.h"

namespace toile::evaluate {
namespace {

using ::testing::HasSubstr;

StabilityCase case_named(const std::string& name) {
    for (StabilityCase& one : stability_cases())
        if (one.name == name) return one;
    throw Error("there is no case " + name);
}

TEST(EnergyTrace, CountsRisesInHeightOfTheGarment) {
    EnergyTrace trace(2.0);
    for (const double energy : {5.0, 3.0, 3.0 + 1e-6, 4.0}) trace.add({energy, 0.0, energy == 5.0});
    EXPECT_TRUE(trace.measured());
    EXPECT_EQ(trace.steps(), 3);
    EXPECT_EQ(trace.rises(), 1) << "a rounding error is none, half a metre is not";
    EXPECT_NEAR(trace.largest_rise(), 0.5, 1e-6);
}

TEST(EnergyTrace, SpringsMayGiveBackWhatTheyHeldAndNoMore) {
    EnergyTrace trace(1.0);
    trace.add({1.0, 0.5, true});
    trace.add({1.4, 0.0, false});
    EXPECT_EQ(trace.rises(), 0) << "they held half a joule";
    trace.add({1.5, 0.5, false});
    EXPECT_EQ(trace.rises(), 1) << "they held nothing before this step";
    EXPECT_NEAR(trace.largest_rise(), 0.1, 1e-12);
}

TEST(EnergyTrace, ANewTryMaySetOutFromHigherUp) {
    EnergyTrace trace(1.0);
    trace.add({1.0, 0.0, true});
    trace.add({9.0, 0.0, true});
    trace.add({8.0, 0.0, false});
    EXPECT_EQ(trace.rises(), 0);
    EXPECT_EQ(trace.largest_rise(), 0.0);
}

TEST(EnergyTrace, WithoutAnEnergyNothingIsClaimed) {
    EnergyTrace trace(1.0);
    trace.add({std::numeric_limits<double>::quiet_NaN(), 0.0, true});
    EXPECT_FALSE(trace.measured());
    EXPECT_TRUE(std::isnan(trace.largest_rise()));
}

/// A few of the suite's extremes, one of each group, small enough for a debug build.
class QuickCase : public ::testing::TestWithParam<const char*> {};
TEST_P(QuickCase, ImplicitPasses) {
    const StabilityOutcome outcome = run_stability_case(case_named(GetParam()), "implicit");
    EXPECT_TRUE(outcome.rests) << outcome.status;
    EXPECT_TRUE(outcome.finite);
    EXPECT_TRUE(outcome.falling) << "energy rose by " << outcome.energy_rise << " m";
    EXPECT_FALSE(std::isnan(outcome.energy_rise)) << "measured";
    EXPECT_GT(outcome.iterations, 0);
}
INSTANTIATE_TEST_SUITE_P(Stability, QuickCase,
                         ::testing::Values("membrane stiffness 0.001 x, hanging",
                                           "bending stiffness 100000 x, on a sphere", "density 10 kg/m^2, hanging",
                                           "time step 0.1 s, hanging", "friction 2, on a table", "inverted, hanging",
                                           "edges from 1 to 30 in one mesh, on a table",
                                           "triangles of aspect 1000, on a sphere",
                                           "membrane stiffness 100000 x, on a sphere"));

TEST(Stability, ACaseThatCannotRestIsNotPassed) {
    StabilityCase falling = case_named("density 10 kg/m^2, hanging");
    falling.build = [build = falling.build] {
        StabilityScene scene = build();
        scene.drape.pinned.clear();
        scene.drape.solver.max_iterations = 20;
        scene.drape.ladder.tries = 0;
        return scene;
    };
    const StabilityOutcome outcome = run_stability_case(falling, "implicit");
    EXPECT_FALSE(outcome.rests);
    EXPECT_FALSE(outcome.passed());
    EXPECT_EQ(outcome.status, "not_at_rest");
}

TEST(Stability, ABudgetBoundsATryAndTheirNumber) {
    const StabilityOutcome outcome = run_stability_case(case_named("density 10 kg/m^2, hanging"), "implicit", {3, 0});
    EXPECT_EQ(outcome.status, "not_at_rest");
    EXPECT_EQ(outcome.iterations, 3);
    EXPECT_EQ(outcome.certificate.tries, 1);
}

TEST(Stability, WhatASolverRefusesIsAnOutcome) {
    StabilityCase broken = case_named("density 10 kg/m^2, hanging");
    broken.build = [build = broken.build] {
        StabilityScene scene = build();
        scene.drape.pinned = {100000};
        return scene;
    };
    const StabilityOutcome outcome = run_stability_case(broken, "implicit");
    EXPECT_FALSE(outcome.passed());
    EXPECT_THAT(outcome.status, HasSubstr("refused: pinned vertex 100000"));
}

TEST(Stability, ASolverThatIsNotThereIsSaidToBeMissing) {
    EXPECT_EQ(missing_solver("implicit"), "");
    EXPECT_NE(missing_solver("guesswork"), "");
    StabilityOptions options;
    options.solver = {"guesswork"};
    options.filter = "aspect 1000";
    for (const StabilityOutcome& one : run_stability(options)) {
        EXPECT_FALSE(one.passed());
        EXPECT_THAT(one.status, HasSubstr("not available: "));
    }
}

TEST(Stability, RefusesAFilterThatLeavesNothing) {
    StabilityOptions options;
    options.filter = "no such case";
    EXPECT_THROW(run_stability(options), Error);
}

}  // namespace
}  // namespace toile::evaluate
