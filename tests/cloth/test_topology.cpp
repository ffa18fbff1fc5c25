#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloth/topology.h"

namespace toile {
namespace {

Triangles triangles(std::initializer_list<Eigen::RowVector3i> rows) {
    Triangles triangle(static_cast<int>(rows.size()), 3);
    int f = 0;
    for (const Eigen::RowVector3i& row : rows) triangle.row(f++) = row;
    return triangle;
}

/// A band of `sectors` quads around the y axis, open at both ends.
Triangles band(int sectors) {
    Triangles triangle(2 * sectors, 3);
    for (int j = 0; j < sectors; ++j) {
        const int a = 2 * j, b = 2 * ((j + 1) % sectors);
        triangle.row(2 * j) << a, b, a + 1;
        triangle.row(2 * j + 1) << a + 1, b, b + 1;
    }
    return triangle;
}

TEST(Topology, edges_are_lexicographic_and_know_their_triangles) {
    const Triangles triangle = triangles({{0, 1, 2}, {2, 1, 3}});
    const Topology topology = build_topology(triangle);
    Edges expected(5, 2);
    expected << 0, 1, 0, 2, 1, 2, 1, 3, 2, 3;
    EXPECT_EQ(topology.edge, expected);
    EXPECT_EQ(topology.edge_triangle.row(2), Eigen::RowVector2i(0, 1));
    EXPECT_EQ(topology.edge_triangle.row(0), Eigen::RowVector2i(0, -1));
    EXPECT_EQ(topology.non_manifold_edge, -1);
    for (int f = 0; f < 2; ++f) {
        for (int k = 0; k < 3; ++k) {
            const auto edge = topology.edge.row(topology.triangle_edge(f, k));
            const auto [low, high] = std::minmax(triangle(f, (k + 1) % 3), triangle(f, (k + 2) % 3));
            EXPECT_EQ(edge[0], low);
            EXPECT_EQ(edge[1], high);
        }
    }
}

TEST(Topology, edges_do_not_depend_on_the_order_of_triangles) {
    const Triangles forward = triangles({{0, 1, 2}, {2, 1, 3}, {2, 3, 4}});
    const Triangles backward = triangles({{3, 4, 2}, {1, 3, 2}, {1, 2, 0}});
    EXPECT_EQ(build_topology(forward).edge, build_topology(backward).edge);
}

TEST(Topology, third_triangle_at_an_edge_is_found) {
    const Topology topology = build_topology(triangles({{0, 1, 2}, {2, 1, 3}, {1, 2, 4}}));
    ASSERT_GE(topology.non_manifold_edge, 0);
    EXPECT_EQ(topology.edge.row(topology.non_manifold_edge), Eigen::RowVector2i(1, 2));
}

TEST(Topology, no_triangles_no_edges) {
    EXPECT_EQ(build_topology(Triangles(0, 3)).edge.rows(), 0);
    EXPECT_TRUE(boundary_loops(Triangles(0, 3)).empty());
}

TEST(Topology, band_has_two_boundary_loops) {
    const auto loops = boundary_loops(band(7));
    ASSERT_EQ(loops.size(), 2u);
    for (const auto& loop : loops) EXPECT_EQ(loop.size(), 7u);
    // The mesh is to the left of each edge: the lower loop runs with the triangles' own first edge.
    const auto& lower = loops[0][0] % 2 == 0 ? loops[0] : loops[1];
    const auto at = std::find(lower.begin(), lower.end(), 0) - lower.begin();
    EXPECT_EQ(lower[(at + 1) % 7], 2);
}

TEST(Topology, closed_surface_has_no_boundary) {
    EXPECT_TRUE(boundary_loops(triangles({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})).empty());
}

TEST(Topology, boundaries_that_touch_in_a_vertex_are_complete) {
    size_t count = 0;
    for (const auto& loop : boundary_loops(triangles({{0, 1, 2}, {0, 3, 4}}))) count += loop.size();
    EXPECT_EQ(count, 6u);
}

TEST(Topology, hinges_hold_the_opposite_vertices) {
    const Triangles triangle = triangles({{0, 1, 2}, {2, 1, 3}});
    const auto hinges = build_hinges(build_topology(triangle), triangle);
    ASSERT_EQ(hinges.rows(), 1);
    EXPECT_EQ(hinges.row(0), Eigen::RowVector4i(1, 2, 0, 3));
}

TEST(Topology, components_are_numbered_by_their_first_vertex) {
    const auto component = connected_components(triangles({{4, 5, 6}, {0, 2, 3}}), 7);
    EXPECT_EQ(component, (std::vector<int>{0, 1, 0, 0, 2, 2, 2}));
}

TEST(Topology, normals_of_a_cube_corner_weigh_by_angle) {
    // Two of the three faces at the corner are split through it: by area or count they would weigh more.
    Positions position(7, 3);
    position << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 1;
    const Triangles triangle = triangles({{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}, {0, 1, 5}, {1, 6, 5}});
    const Positions normal = vertex_normals(triangle, position);
    const double third = -1.0 / std::numbers::sqrt3;
    EXPECT_LT((normal.row(0) - Eigen::RowVector3d(third, third, third)).norm(), 1e-14);
}

TEST(Topology, vertex_without_triangles_has_no_normal) {
    Positions position = Positions::Random(4, 3);
    EXPECT_EQ(vertex_normals(triangles({{0, 1, 2}}), position).row(3), Eigen::RowVector3d::Zero());
    position.topRows(3).setZero();
    EXPECT_TRUE(vertex_normals(triangles({{0, 1, 2}}), position).isZero(0.0));
}

}  // namespace
}  // namespace toile
