#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "simulate/gate.h"

namespace toile::simulate {
namespace {

Certificate perfect() {
    Certificate c;
    c.residual_force = 1e-4;
    c.max_speed = 1e-4;
    c.min_stretch = 0.95;
    c.max_stretch = 1.05;
    return c;
}

DrapeStatus judged(GateProfile profile, const std::function<void(Certificate&)>& change) {
    Certificate c = perfect();
    change(c);
    return judge(c, true, gate_of(profile));
}

TEST(Gate, AcceptsWhatMeetsEveryBound) {
    for (const GateProfile profile : {GateProfile::strict, GateProfile::paper, GateProfile::garmentcode}) {
        EXPECT_EQ(judge(perfect(), true, gate_of(profile)), DrapeStatus::accepted);
        EXPECT_EQ(judge(perfect(), false, gate_of(profile)), DrapeStatus::not_finite);
    }
}

TEST(Gate, StrictNamesTheDefectOneByOne) {
    const auto strict = [](const auto& change) { return judged(GateProfile::strict, change); };
    EXPECT_EQ(strict([](Certificate& c) { c.residual_force = 2e-3; }), DrapeStatus::not_at_rest);
    EXPECT_EQ(strict([](Certificate& c) { c.max_speed = 2e-3; }), DrapeStatus::not_at_rest);
    EXPECT_EQ(strict([](Certificate& c) { c.body_penetration = 1.1e-4; }), DrapeStatus::penetrates_body);
    EXPECT_EQ(strict([](Certificate& c) { c.self_intersections = 1; }), DrapeStatus::self_intersects);
    EXPECT_EQ(strict([](Certificate& c) { c.max_stretch = 1.31; }), DrapeStatus::overstretched);
}

TEST(Gate, PaperAllowsAMillimetreAndAnyCrossing) {
    const auto paper = [](const auto& change) { return judged(GateProfile::paper, change); };
    EXPECT_EQ(paper([](Certificate& c) { c.self_intersections = 1000; }), DrapeStatus::accepted);
    EXPECT_EQ(paper([](Certificate& c) { c.body_penetration = 9e-4; }), DrapeStatus::accepted);
    EXPECT_EQ(paper([](Certificate& c) { c.body_penetration = 1.1e-3; }), DrapeStatus::penetrates_body);
    EXPECT_EQ(paper([](Certificate& c) { c.residual_force = 2e-3; }), DrapeStatus::not_at_rest);
}

TEST(Gate, GarmentcodeCountsAsItsSimulatorDoes) {
    const auto theirs = [](const auto& change) { return judged(GateProfile::garmentcode, change); };
    EXPECT_EQ(theirs([](Certificate& c) { c.body_crossings = 35, c.self_intersections = 300; }), DrapeStatus::accepted);
    EXPECT_EQ(theirs([](Certificate& c) { c.body_crossings = 36; }), DrapeStatus::penetrates_body);
    EXPECT_EQ(theirs([](Certificate& c) { c.self_intersections = 301; }), DrapeStatus::self_intersects);
    EXPECT_EQ(theirs([](Certificate& c) { c.moving_share = 0.015; }), DrapeStatus::accepted);
    EXPECT_EQ(theirs([](Certificate& c) { c.moving_share = 0.016; }), DrapeStatus::not_at_rest);
    EXPECT_EQ(theirs([](Certificate& c) { c.residual_force = 1, c.max_speed = 1, c.max_stretch = 2; }),
              DrapeStatus::accepted);
}

TEST(Gate, NotANumberMeetsNoBound) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(judged(GateProfile::strict, [&](Certificate& c) { c.residual_force = nan; }), DrapeStatus::not_at_rest);
    EXPECT_EQ(judged(GateProfile::strict, [&](Certificate& c) { c.max_stretch = nan; }), DrapeStatus::overstretched);
}

TEST(Gate, TheBoundsAreThoseThatAreAsked) {
    EXPECT_EQ(gate_bounds(gate_of(GateProfile::strict)), (std::map<std::string, double>{{"residual_force", 0.001},
                                                                                        {"max_speed", 0.001},
                                                                                        {"body_penetration", 1e-4},
                                                                                        {"self_intersections", 0},
                                                                                        {"max_stretch", 1.3}}));
    EXPECT_EQ(
        gate_bounds(gate_of(GateProfile::garmentcode)),
        (std::map<std::string, double>{{"moving_share", 0.015}, {"body_crossings", 35}, {"self_intersections", 300}}));
}

}  // namespace
}  // namespace toile::simulate
