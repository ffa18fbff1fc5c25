#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "cloth/topology.h"
#include "skin/hole_filling.h"

namespace toile::skin {
namespace {

/// A tube around the y axis, wound outwards, open at both ends; `rings` of `around` vertices.
struct Tube {
    Triangles triangle;
    Positions position;

    Tube(int rings, int around) : triangle(2 * (rings - 1) * around, 3), position(rings * around, 3) {
        for (int r = 0; r < rings; ++r)
            for (int k = 0; k < around; ++k)
                position.row(r * around + k) << std::sin(2 * M_PI * k / around), r, std::cos(2 * M_PI * k / around);
        int f = 0;
        for (int r = 0; r + 1 < rings; ++r) {
            for (int k = 0; k < around; ++k) {
                const int a = r * around + k, b = r * around + (k + 1) % around;
                triangle.row(f++) << a, b, b + around;
                triangle.row(f++) << a, b + around, a + around;
            }
        }
    }
};

double volume(const Triangles& triangle, const Positions& p) {
    double sum = 0;
    for (int f = 0; f < triangle.rows(); ++f) {
        Eigen::Matrix3d corner;
        for (int k = 0; k < 3; ++k) corner.row(k) = p.row(triangle(f, k));
        sum += corner.row(0).dot(corner.row(1).cross(corner.row(2))) / 6;
    }
    return sum;
}

TEST(FillHoles, ClosesATubeWithTheSameWinding) {
    const Tube tube(4, 24);
    const FilledHoles closed = fill_holes(tube.triangle, tube.position);
    EXPECT_EQ(closed.filled, 2);
    EXPECT_EQ(closed.open, 0);
    EXPECT_TRUE(boundary_loops(closed.triangle).empty());
    EXPECT_EQ(closed.triangle.topRows(tube.triangle.rows()), tube.triangle);
    EXPECT_EQ(closed.triangle.rows(), tube.triangle.rows() + 2 * 22);
    // Were a cap wound the other way its part of the volume would be subtracted.
    const double area = 0.5 * 24 * std::sin(2 * M_PI / 24);
    EXPECT_NEAR(volume(closed.triangle, tube.position), 3 * area, 1e-9);
}

TEST(FillHoles, LeavesAClosedSurfaceAlone) {
    const Tube tube(3, 6);
    const Triangles closed = fill_holes(tube.triangle, tube.position).triangle;
    const FilledHoles again = fill_holes(closed, tube.position);
    EXPECT_EQ(again.filled, 0);
    EXPECT_EQ(again.triangle, closed);
}

TEST(FillHoles, ClosesABentHole) {
    Tube tube(3, 16);
    for (int k = 0; k < 16; ++k) tube.position(2 * 16 + k, 1) += 0.4 * std::sin(4 * M_PI * k / 16);
    const FilledHoles closed = fill_holes(tube.triangle, tube.position);
    EXPECT_EQ(closed.filled, 2);
    EXPECT_TRUE(boundary_loops(closed.triangle).empty());
}

}  // namespace
}  // namespace toile::skin
