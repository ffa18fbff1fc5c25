#include <gtest/gtest.h>

#include <limits>

#include "cloth/error.h"
#include "simulate/crossings.h"
#include "simulate/self_intersection.h"
#include "simulate/untangle.h"
#include "tests/simulate/tangled_cloth.h"

namespace toile::simulate {
namespace {

struct Outcome {
    UntangleReport report;
    Positions position;
};

Outcome untangled(const test::Surface& from, const std::vector<int>& pinned = {}, const UntangleOptions& options = {}) {
    Outcome outcome{{}, from.position};
    outcome.report = untangle(from.triangle, build_topology(from.triangle), pinned, options, outcome.position);
    return outcome;
}

/// Nothing crosses any more, no vertex moved further than `largest_move` [m], no edge changed by more than the options
/// allow.
void expect_mended(const test::Surface& from, double largest_move) {
    const Topology topology = build_topology(from.triangle);
    const Outcome outcome = untangled(from);
    EXPECT_EQ(outcome.report.status, UntangleStatus::untangled);
    EXPECT_GT(outcome.report.crossings_before, 0);
    EXPECT_EQ(outcome.report.crossings_after, 0);
    EXPECT_DOUBLE_EQ(outcome.report.gap, UntangleOptions{}.separation);
    EXPECT_EQ(count_self_intersections(from.triangle, outcome.position), 0);
    EXPECT_LE(outcome.report.largest_move, largest_move);
    EXPECT_DOUBLE_EQ(outcome.report.largest_move, (outcome.position - from.position).rowwise().norm().maxCoeff());
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const int a = topology.edge(e, 0), b = topology.edge(e, 1);
        const double ratio = (outcome.position.row(a) - outcome.position.row(b)).norm() /
                             (from.position.row(a) - from.position.row(b)).norm();
        EXPECT_GT(ratio, 0.45);
        EXPECT_LT(ratio, 1.2);
    }
}

TEST(Untangle, LeavesWhatDoesNotCrossAlone) {
    const test::Surface from = test::surface(test::cloth_square(6, 0.3, 0.0));
    const Outcome outcome = untangled(from);
    EXPECT_EQ(outcome.report.status, UntangleStatus::clean);
    EXPECT_EQ(outcome.report.iterations, 0);
    EXPECT_EQ(outcome.position, from.position);
}

TEST(Untangle, TakesABumpBackThroughALayer) {
    expect_mended(test::layers_with_bump(0.005), 0.010);
}
TEST(Untangle, TakesADeepBumpBackThroughALayer) {
    expect_mended(test::layers_with_bump(0.015), 0.025);
}
TEST(Untangle, PullsACornerOutOfASheet) {
    expect_mended(test::corner_through_sheet(0.01), 0.020);
}
TEST(Untangle, PullsTheTipOfAFoldOut) {
    expect_mended(test::fold_with_tip(), 0.016);
}
TEST(Untangle, OpensAnArmpit) {
    expect_mended(test::armpit(0.01), 0.020);
}

TEST(Untangle, PutsNoisyLayersApart) {
    expect_mended(test::noisy_layers(), 0.015);
}

TEST(Untangle, PinsStay) {
    const test::Surface from = test::layers_with_bump(0.005);
    std::vector<int> pinned;
    for (int v = 0; v < 21 * 21; ++v) pinned.push_back(v);  // the layer with the bump
    const Outcome outcome = untangled(from, pinned);
    EXPECT_EQ(outcome.report.crossings_after, 0);
    EXPECT_EQ(outcome.position.topRows(21 * 21), from.position.topRows(21 * 21));
}

TEST(Untangle, WhereAllIsPinnedSaysSo) {
    const test::Surface from = test::layers_with_bump(0.005);
    std::vector<int> pinned;
    for (int v = 0; v < from.position.rows(); ++v) pinned.push_back(v);
    const Outcome outcome = untangled(from, pinned);
    EXPECT_EQ(outcome.report.status, UntangleStatus::tangled);
    EXPECT_EQ(outcome.report.crossings_after, outcome.report.crossings_before);
    EXPECT_EQ(outcome.position, from.position);
}

TEST(Untangle, ACrumpledStateEndsWithTheBudgetNoWorse) {
    test::Surface from = test::surface(test::cloth_square(10, 0.1, 0.0));
    from.position = test::crumpled(from.position, 0.05);
    UntangleOptions options;
    options.max_iterations = 5;
    const Outcome outcome = untangled(from, {}, options);
    EXPECT_EQ(outcome.report.status, UntangleStatus::tangled);
    EXPECT_EQ(outcome.report.iterations, 5);
    EXPECT_EQ(outcome.report.gap, 0.0);
    EXPECT_TRUE(outcome.position.allFinite());
    EXPECT_LE(outcome.report.crossings_after, outcome.report.crossings_before);
    EXPECT_EQ(static_cast<int>(find_crossings(from.triangle, build_topology(from.triangle), outcome.position).size()),
              outcome.report.crossings_after);
}

TEST(Untangle, OneVertexAMetreAwayThroughTheOtherLayer) {
    test::Surface from = test::joined(test::surface(test::cloth_square(12, 0.15, 0.0)),
                                      test::surface(test::cloth_square(12, 0.15, 0.02)));
    from.position(60, 1) += 1.0;
    const Outcome outcome = untangled(from);
    EXPECT_GT(outcome.report.crossings_before, 0);
    EXPECT_EQ(outcome.report.status, UntangleStatus::untangled);
    EXPECT_EQ(count_self_intersections(from.triangle, outcome.position), 0);
}

TEST(Untangle, StaysFiniteWhereSquaresOverflow) {
    test::Surface from = test::layers_with_bump(0.005);
    from.position *= 1e200;
    const Outcome outcome = untangled(from);
    EXPECT_EQ(outcome.report.status, UntangleStatus::tangled);
    EXPECT_TRUE(outcome.position.allFinite());
}

TEST(Untangle, GivesTheSameBytesAgain) {
    const test::Surface from = test::fold_with_tip();
    EXPECT_EQ(untangled(from).position, untangled(from).position);
}

TEST(Untangle, RefusesOneDefectAtATime) {
    const test::Surface from = test::layers_with_bump(0.005);
    EXPECT_THROW(untangled(from, {-1}), Error);
    EXPECT_THROW(untangled(from, {static_cast<int>(from.position.rows())}), Error);
    test::Surface broken = from;
    broken.position(3, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(untangled(broken), Error);

    const auto refused = [&](auto change) {
        UntangleOptions options;
        change(options);
        EXPECT_THROW(untangled(from, {}, options), Error);
    };
    refused([](UntangleOptions& o) { o.max_iterations = 0; });
    refused([](UntangleOptions& o) { o.separation = -1e-4; });
    refused([](UntangleOptions& o) { o.largest_step = 0.0; });
    refused([](UntangleOptions& o) { o.largest_step = 1.5; });
    refused([](UntangleOptions& o) { o.max_stretch = 0.0; });
    refused([](UntangleOptions& o) { o.max_shrink = 1.0; });
}

}  // namespace
}  // namespace toile::simulate
