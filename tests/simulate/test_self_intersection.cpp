#include <gtest/gtest.h>

#include "simulate/self_intersection.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

TEST(SelfIntersection, AFlatClothHasNone) {
    const ClothMesh mesh = test::cloth_square(6, 0.3, 0.0);
    EXPECT_EQ(count_self_intersections(mesh.triangle, mesh.rest_position), 0);
}

TEST(SelfIntersection, AClothBentOverHasNone) {
    ClothMesh mesh = test::cloth_square(6, 0.3, 0.0);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const double s = mesh.rest_position(v, 0) / 0.1;
        mesh.rest_position.row(v) << 0.1 * std::sin(s), 0.1 * std::cos(s), mesh.rest_position(v, 2);
    }
    EXPECT_EQ(count_self_intersections(mesh.triangle, mesh.rest_position), 0);
}

TEST(SelfIntersection, TwoTrianglesThatCrossAreOnePair) {
    Triangles triangle(2, 3);
    triangle << 0, 1, 2, 3, 4, 5;
    Positions x(6, 3);
    x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, -1, 0.2, 0.2, 1, 2, 2, 0.5;
    EXPECT_EQ(count_self_intersections(triangle, x), 1);
    x.bottomRows(3).col(2).array() += 1.5;
    EXPECT_EQ(count_self_intersections(triangle, x), 0);
}

}  // namespace
}  // namespace toile::simulate
