#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <utility>

#include "cloth/error.h"
#include "simulate/crossings.h"
#include "simulate/self_intersection.h"
#include "tests/simulate/tangled_cloth.h"

namespace toile::simulate {
namespace {

std::vector<Crossing> crossings_of(const test::Surface& surface) {
    return find_crossings(surface.triangle, build_topology(surface.triangle), surface.position);
}

/// Pairs of triangles that the listed crossings prove to intersect.
int pair_count(const test::Surface& surface) {
    const Topology topology = build_topology(surface.triangle);
    std::set<std::pair<int, int>> pairs;
    for (const Crossing& crossing : find_crossings(surface.triangle, topology, surface.position))
        for (int side = 0; side < 2; ++side)
            if (const int f = topology.edge_triangle(crossing.edge, side); f >= 0)
                pairs.emplace(std::minmax(f, crossing.triangle));
    return static_cast<int>(pairs.size());
}

TEST(Crossings, AClothWithoutThemHasNone) {
    EXPECT_TRUE(crossings_of(test::surface(test::cloth_square(8, 0.3, 0.0))).empty());
}

TEST(Crossings, NamesEdgeAndTriangle) {
    test::Surface two{Triangles(2, 3), Positions(6, 3)};
    two.triangle << 0, 1, 2, 3, 4, 5;
    two.position << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, -1, 0.2, 0.2, 1, 2, 2, 0.5;
    const Topology topology = build_topology(two.triangle);
    const std::vector<Crossing> found = crossings_of(two);
    ASSERT_EQ(found.size(), 2u);  // the second triangle enters by one edge and leaves the first by another
    EXPECT_EQ(topology.edge.row(found[0].edge), Eigen::RowVector2i(1, 2));
    EXPECT_EQ(found[0].triangle, 1);
    EXPECT_EQ(topology.edge.row(found[1].edge), Eigen::RowVector2i(3, 4));
    EXPECT_EQ(found[1].triangle, 0);
}

TEST(Crossings, TouchingCounts) {
    test::Surface two{Triangles(2, 3), Positions(6, 3)};
    two.triangle << 0, 1, 2, 3, 4, 5;
    two.position << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0, 0.2, 0.2, 1, 2, 2, 0.5;
    EXPECT_FALSE(crossings_of(two).empty());
    two.position(3, 2) = std::numeric_limits<double>::denorm_min();
    EXPECT_TRUE(crossings_of(two).empty());
}

TEST(Crossings, AFanFoldedThroughItselfCrossesBesideTheSharedVertex) {
    test::Surface fan{Triangles(2, 3), Positions(5, 3)};
    fan.triangle << 0, 1, 2, 0, 3, 4;
    fan.position << 0, 0, 0, 1, -1, 0, 1, 1, 0, 0.5, 0, -0.5, 0.5, 0, 0.5;
    EXPECT_EQ(crossings_of(fan).size(), 1u);
    fan.position.bottomRows(2).col(0).array() *= -1.0;
    EXPECT_TRUE(crossings_of(fan).empty());
}

TEST(Crossings, ProveAsManyPairsAsTrianglesTestedAgainstTrianglesGive) {
    for (const test::Surface& surface : {test::layers_with_bump(0.005), test::corner_through_sheet(0.02),
                                         test::fold_with_tip(), test::armpit(0.01), test::noisy_layers()}) {
        const int pairs = count_self_intersections(surface.triangle, surface.position);
        EXPECT_GT(pairs, 0);
        EXPECT_EQ(pair_count(surface), pairs);
    }
}

TEST(Crossings, RefusesPositionsThatAreNotFinite) {
    test::Surface surface = test::surface(test::cloth_square(2, 0.3, 0.0));
    surface.position(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(crossings_of(surface), Error);
}

}  // namespace
}  // namespace toile::simulate
