#include <gtest/gtest.h>

#include "bench/speed_scene.h"

namespace toile::bench {
namespace {

TEST(SpeedScene, HalfOfTheEdgesAreOverstretched) {
    const SpeedScene scene = speed_scene(53, 56, 16);
    EXPECT_EQ(scene.rest.vertex_count, 2968);
    EXPECT_EQ(scene.rest.edge.rows(), 8798);
    EXPECT_EQ(scene.predicted.size(), 16u * 3 * 2968);
    EXPECT_NEAR(scene.overstretched_share(), 0.5, 0.1);
}

TEST(SpeedScene, IsTheSameEachTime) {
    EXPECT_EQ(speed_scene(10, 9, 3).predicted, speed_scene(10, 9, 3).predicted);
}

}  // namespace
}  // namespace toile::bench
