#include <gtest/gtest.h>

#include "simulate/contours.h"
#include "tests/simulate/tangled_cloth.h"

namespace toile::simulate {
namespace {

struct Traced {
    Topology topology;
    std::vector<Crossing> crossing;
    std::vector<Contour> contours;
};

Traced traced(const test::Surface& surface) {
    Traced traced{build_topology(surface.triangle), {}, {}};
    traced.crossing = find_crossings(surface.triangle, traced.topology, surface.position);
    traced.contours = trace_contours(surface.triangle, traced.topology, traced.crossing);
    return traced;
}

TEST(Contours, ABumpThroughALayerHasOneWithTheEdgesOfBothSheetsTold) {
    const Traced bump = traced(test::layers_with_bump(0.005));
    ASSERT_EQ(bump.contours.size(), 1u);
    const Contour& contour = bump.contours[0];
    EXPECT_TRUE(contour.loop_vertex.empty());
    ASSERT_EQ(contour.crossing.size(), bump.crossing.size());
    const int lower_count = 21 * 21;  // vertices of the first layer
    const bool first_is_lower = bump.topology.edge(bump.crossing[0].edge, 0) < lower_count;
    for (std::size_t k = 0; k < contour.crossing.size(); ++k) {
        EXPECT_EQ(contour.crossing[k], static_cast<int>(k));
        const bool lower = bump.topology.edge(bump.crossing[k].edge, 0) < lower_count;
        EXPECT_EQ(contour.of_second[k], lower != first_is_lower);
    }
}

TEST(Contours, TwoBumpsHaveTwo) {
    const test::Surface one = test::layers_with_bump(0.005);
    test::Surface far = one;
    far.position.col(0).array() += 1.0;
    EXPECT_EQ(traced(test::joined(one, far)).contours.size(), 2u);
}

TEST(Contours, AFanFoldedThroughItselfEndsAtTheSharedVertex) {
    test::Surface fan{Triangles(2, 3), Positions(5, 3)};
    fan.triangle << 0, 1, 2, 0, 3, 4;
    fan.position << 0, 0, 0, 1, -1, 0, 1, 1, 0, 0.5, 0, -0.5, 0.5, 0, 0.5;
    const Traced folded = traced(fan);
    ASSERT_EQ(folded.contours.size(), 1u);
    EXPECT_EQ(folded.contours[0].loop_vertex, std::vector<int>{0});
}

TEST(Contours, NoCrossingNoContour) {
    EXPECT_TRUE(traced(test::surface(test::cloth_square(4, 0.3, 0.0))).contours.empty());
}

}  // namespace
}  // namespace toile::simulate
