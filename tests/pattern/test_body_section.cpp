#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pattern/body_section.h"

namespace toile::pattern {
namespace {

std::vector<Eigen::Vector2d> square() {
    return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0.3, 0.2}, {1, 0}};
}

TEST(TapeLoop, lies_along_the_hull) {
    const TapeLoop loop(square(), 0.0);
    EXPECT_NEAR(loop.length(), 8.0, 1e-12);
    for (double s : {0.0, 0.7, 3.9, 7.99, -2.0, 21.0})
        EXPECT_NEAR(loop.at(s).lpNorm<Eigen::Infinity>(), 1.0, 1e-12) << s;
    EXPECT_LT((loop.at(1.5) - loop.at(9.5)).norm(), 1e-12);
}

TEST(TapeLoop, offset_adds_a_circle) {
    const TapeLoop loop(square(), 0.5);
    EXPECT_NEAR(loop.length(), 8.0 + 2.0 * std::numbers::pi * 0.5, 0.01);
    for (const Eigen::Vector2d& corner : loop.corner()) {
        const Eigen::Vector2d inside = corner.cwiseMax(-1.0).cwiseMin(1.0);
        EXPECT_NEAR((corner - inside).norm(), 0.5, 1e-12);
    }
}

TEST(TapeLoop, runs_counter_clockwise) {
    const TapeLoop loop(square(), 0.0);
    const double right = loop.leaves_at({0, 0}, {1, 0}), top = loop.leaves_at({0, 0}, {0, 1});
    EXPECT_LT((loop.at(right) - Eigen::Vector2d(1, 0)).norm(), 1e-12);
    EXPECT_LT((loop.at(top) - Eigen::Vector2d(0, 1)).norm(), 1e-12);
    EXPECT_LT((loop.at(right + 2.0) - loop.at(top)).norm(), 1e-12);
}

TEST(TapeLoop, too_few_points_have_no_length) {
    EXPECT_EQ(TapeLoop({{0, 0}, {1, 0}}, 0.1).length(), 0.0);
    EXPECT_EQ(TapeLoop({}, 0.1).length(), 0.0);
}

TEST(PlaneSection, cuts_a_tetrahedron) {
    Positions position(4, 3);
    position << 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0;
    Triangles triangle(4, 3);
    triangle << 0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0;
    const auto points = plane_section(triangle, position, {0, 0.25, 0}, {0, 1, 0});
    ASSERT_EQ(points.size(), 6u);  // three triangles, two points each
    for (const Eigen::Vector3d& p : points) {
        EXPECT_NEAR(p.y(), 0.25, 1e-15);
        EXPECT_LE(p.x() + p.z(), 0.75 + 1e-12);
    }
    EXPECT_TRUE(plane_section(triangle, position, {0, 2, 0}, {0, 1, 0}).empty());
}

}  // namespace
}  // namespace toile::pattern
