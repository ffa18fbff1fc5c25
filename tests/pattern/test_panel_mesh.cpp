#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/panel_mesh.h"

namespace toile::pattern {
namespace {

/// A rounded outline with a bay, cut into pieces of about 0.02 m.
PlanePositions outline() {
    PlanePositions boundary(160, 2);
    for (int i = 0; i < 160; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 160;
        const double radius = 0.45 - 0.13 * std::cos(3.0 * angle);
        boundary.row(i) << radius * std::cos(angle), radius * std::sin(angle);
    }
    return boundary;
}

double area(const PlanePositions& p, int a, int b, int c) {
    const Eigen::RowVector2d u = p.row(b) - p.row(a), v = p.row(c) - p.row(a);
    return 0.5 * (u.x() * v.y() - u.y() * v.x());
}

TEST(PanelMesh, fills_the_outline_with_well_shaped_triangles) {
    const PlanePositions boundary = outline();
    const PanelMesh panel = mesh_panel(boundary, 0.02);
    double sum = 0.0, smallest_angle = 180.0, outline_area = 0.0;
    for (int f = 0; f < panel.triangle.rows(); ++f) {
        sum += area(panel.position, panel.triangle(f, 0), panel.triangle(f, 1), panel.triangle(f, 2));
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d at = panel.position.row(panel.triangle(f, k));
            const Eigen::RowVector2d u = panel.position.row(panel.triangle(f, (k + 1) % 3)) - at;
            const Eigen::RowVector2d v = panel.position.row(panel.triangle(f, (k + 2) % 3)) - at;
            const double turn = u.x() * v.y() - u.y() * v.x();
            EXPECT_GT(turn, 0.0);
            smallest_angle = std::min(smallest_angle, std::atan2(turn, u.dot(v)) * 180.0 / std::numbers::pi);
        }
    }
    for (int i = 0; i < boundary.rows(); ++i) {
        const int j = (i + 1) % static_cast<int>(boundary.rows());
        outline_area += 0.5 * (boundary(i, 0) * boundary(j, 1) - boundary(i, 1) * boundary(j, 0));
    }
    EXPECT_NEAR(sum, outline_area, 1e-12);
    EXPECT_GT(smallest_angle, 25.0);
    // The number of vertices follows from area and edge length.
    EXPECT_NEAR(panel.position.rows(), outline_area / (0.02 * 0.02 * std::sqrt(0.75)) + 80, 60);
}

TEST(PanelMesh, keeps_the_boundary_as_it_is) {
    const PlanePositions boundary = outline();
    const PanelMesh panel = mesh_panel(boundary, 0.02);
    EXPECT_EQ(panel.position.topRows(boundary.rows()), boundary);
    const auto loops = boundary_loops(panel.triangle);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_EQ(static_cast<long>(loops[0].size()), boundary.rows());
    EXPECT_TRUE(std::all_of(loops[0].begin(), loops[0].end(), [&](int v) { return v < boundary.rows(); }));
}

TEST(PanelMesh, is_the_same_each_time_wherever_it_lies_in_memory) {
    const PanelMesh one = mesh_panel(outline(), 0.03);
    // Holes of many sizes, freed in another order than they were made: what is built next lies elsewhere.
    std::vector<std::unique_ptr<char[]>> hole(4000);
    for (size_t k = 0; k < hole.size(); ++k) hole[k] = std::make_unique<char[]>(16 + 48 * (k * 37 % 101));
    for (size_t k = 0; k < hole.size(); k += 2) hole[k * 1237 % hole.size()].reset();
    for (int round = 0; round < 3; ++round) {
        const PanelMesh other = mesh_panel(outline(), 0.03);
        EXPECT_EQ(one.position, other.position);
        EXPECT_EQ(one.triangle, other.triangle);
    }
}

TEST(PanelMesh, refuses_an_outline_that_crosses_itself) {
    PlanePositions bow(4, 2);
    bow << 0, 0, 1, 1, 1, 0, 0, 1;
    EXPECT_THROW(mesh_panel(bow, 0.1), Error);
}

TEST(PanelMesh, refuses_an_outline_that_runs_the_wrong_way) {
    EXPECT_THROW(mesh_panel(outline().colwise().reverse(), 0.02), Error);
}

TEST(PanelMesh, refuses_an_outline_of_two_points) {
    PlanePositions two(2, 2);
    two << 0, 0, 1, 1;
    EXPECT_THROW(mesh_panel(two, 0.1), Error);
}

}  // namespace
}  // namespace toile::pattern
