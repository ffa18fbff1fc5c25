#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pattern/weld.h"

namespace toile::pattern {
namespace {

using testing::ElementsAre;

Positions points() {
    Positions position(6, 3);
    position << 0, 0, 0, 1, 0, 0, 0, 0, 0, 1.00005, 0, 0, 1.00012, 0, 0, 5, 5, 5;
    return position;
}

TEST(Weld, equal_positions_are_one) {
    int count = 0;
    EXPECT_THAT(weld_positions(points(), 0.0, count), ElementsAre(0, 1, 0, 2, 3, 4));
    EXPECT_EQ(count, 5);
}

TEST(Weld, near_positions_are_one_across_cells) {
    int count = 0;
    EXPECT_THAT(weld_positions(points(), 6e-5, count), ElementsAre(0, 1, 0, 1, 2, 3));
    EXPECT_THAT(weld_positions(points(), 1e-4, count), ElementsAre(0, 1, 0, 1, 1, 2));  // through the one between
    EXPECT_EQ(count, 3);
}

TEST(Weld, nothing_to_weld) {
    int count = -1;
    EXPECT_TRUE(weld_positions(Positions(0, 3), 0.1, count).empty());
    EXPECT_EQ(count, 0);
}

TEST(Weld, median_edge_ignores_a_few_long_ones) {
    Positions position(5, 3);
    position << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 100, 0, 0;
    Triangles triangle(3, 3);
    triangle << 0, 1, 2, 1, 3, 2, 1, 4, 3;
    EXPECT_NEAR(median_edge(triangle, position), 1.0, 1e-12);
    EXPECT_EQ(median_edge(Triangles(0, 3), position), 0.0);
}

}  // namespace
}  // namespace toile::pattern
