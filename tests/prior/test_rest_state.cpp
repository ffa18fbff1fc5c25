#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "prior/rest_state.h"

namespace toile::prior {
namespace {

using testing::HasSubstr;

/// Two triangles at the edge (0, 1), folded at a right angle: vertex 2 over 0.25 of it, vertex 3 over its middle.
ClothMesh folded() {
    ClothMesh mesh;
    mesh.rest_position.resize(4, 3);
    mesh.rest_position << 0, 0, 0, 2, 0, 0, 0.5, 1, 0, 1, 0, 3;
    mesh.triangle.resize(2, 3);
    mesh.triangle << 0, 1, 2, 1, 0, 3;
    return mesh;
}

/// The same in a pattern where both triangles are halves of a 1 m by 2 m rectangle.
ClothMesh with_pattern() {
    ClothMesh mesh = folded();
    mesh.pattern_position.resize(6, 2);
    mesh.pattern_position << 0, 0, 1, 2, 0, 2, 6, 2, 5, 0, 6, 0;
    mesh.pattern_triangle.resize(2, 3);
    mesh.pattern_triangle << 0, 1, 2, 3, 4, 5;
    return mesh;
}

std::string refusal(const ClothMesh& mesh) {
    try {
        rest_state(mesh, "tube.h5");
    } catch (const Error& error) {
        EXPECT_EQ(error.where(), "tube.h5");
        return error.what();
    }
    return {};
}

TEST(RestState, measures_the_rest_position_where_there_is_no_pattern) {
    const RestState rest = rest_state(folded());
    ASSERT_EQ(rest.vertex_count, 4);
    Edges edge(5, 2);
    edge << 0, 1, 0, 2, 0, 3, 1, 2, 1, 3;
    EXPECT_EQ(rest.edge, edge);
    const double length[] = {2, std::sqrt(1.25), std::sqrt(10.0), std::sqrt(3.25), std::sqrt(10.0)};
    for (int e = 0; e < 5; ++e) EXPECT_DOUBLE_EQ(rest.edge_rest_length[e], length[e]);
    // a third of areas 1 and 3
    for (int v = 0; v < 4; ++v) EXPECT_NEAR(rest.mass[v], (v < 2 ? 4.0 : v == 2 ? 1.0 : 3.0) / 3, 1e-15);
}

TEST(RestState, unfolds_a_hinge_into_one_plane) {
    const RestState rest = rest_state(folded());
    ASSERT_EQ(rest.hinge.rows(), 1);
    EXPECT_EQ(rest.hinge.row(0), Eigen::RowVector4i(0, 1, 2, 3));
    // unfolded: c = (0.5, 1), d = (1, -3)
    EXPECT_NEAR(rest.hinge_rest_length[0], std::hypot(0.5, 4.0), 1e-14);
    EXPECT_NEAR(rest.hinge_crossing(0, 0), 0.625 / 2, 1e-14);
    EXPECT_NEAR(rest.hinge_crossing(0, 1), 0.25, 1e-14);
}

TEST(RestState, the_pattern_comes_before_the_rest_position) {
    const RestState rest = rest_state(with_pattern());
    const double length[] = {std::sqrt(5.0), 2, 1, 1, 2};
    for (int e = 0; e < 5; ++e) EXPECT_DOUBLE_EQ(rest.edge_rest_length[e], length[e]);
    EXPECT_NEAR(rest.mass.sum(), 2.0, 1e-15);
    EXPECT_NEAR(rest.hinge_rest_length[0], std::sqrt(5.0), 1e-14);
    EXPECT_NEAR(rest.hinge_crossing(0, 0), 0.5, 1e-14);
    EXPECT_NEAR(rest.hinge_crossing(0, 1), 0.5, 1e-14);
}

TEST(RestState, a_seam_rests_at_the_mean_of_its_two_pattern_lengths) {
    ClothMesh mesh = with_pattern();
    mesh.pattern_position.row(3) << 5, 3;  // the second panel's copy of the shared edge is 3 m long
    EXPECT_DOUBLE_EQ(rest_state(mesh).edge_rest_length[0], (std::sqrt(5.0) + 3) / 2);
}

TEST(RestState, a_line_beside_the_edge_meets_it_outside) {
    ClothMesh mesh = folded();
    mesh.rest_position.row(2) << 3, 1, 0;
    mesh.rest_position.row(3) << 4, -1, 0;
    const RestState rest = rest_state(mesh);
    EXPECT_NEAR(rest.hinge_crossing(0, 0), 3.5 / 2, 1e-14);
    EXPECT_NEAR(rest.hinge_crossing(0, 1), 0.5, 1e-14);
}

TEST(RestState, every_pair_of_triangles_at_an_edge_is_a_hinge) {
    ClothMesh mesh = folded();
    mesh.rest_position.conservativeResize(5, 3);
    mesh.rest_position.row(4) << 1, -1, 0;
    mesh.triangle.conservativeResize(4, 3);
    mesh.triangle.row(2) << 0, 1, 4;
    mesh.triangle.row(3) << 1, 2, 0;  // the first triangle again: c == d with it, hinges with the others
    const RestState rest = rest_state(mesh);
    EXPECT_EQ(rest.edge.rows(), 7);
    Hinges hinge(5, 4);
    hinge << 0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 3, 4, 0, 1, 3, 2, 0, 1, 4, 2;
    EXPECT_EQ(rest.hinge, hinge);
}

TEST(RestState, winding_changes_nothing) {
    ClothMesh turned = folded();
    turned.triangle.row(1) << 3, 0, 1;
    const RestState a = rest_state(folded()), b = rest_state(turned);
    EXPECT_EQ(a.hinge, b.hinge);
    EXPECT_EQ(a.edge_rest_length, b.edge_rest_length);
    EXPECT_EQ(a.hinge_crossing, b.hinge_crossing);
}

TEST(RestState, components_and_isolated_vertices_are_welcome) {
    ClothMesh mesh = folded();
    mesh.rest_position.conservativeResize(8, 3);
    mesh.rest_position.bottomRows(4) << 9, 9, 9, 20, 0, 0, 23, 0, 0, 20, 4, 0;
    mesh.triangle.conservativeResize(3, 3);
    mesh.triangle.row(2) << 5, 6, 7;
    const RestState rest = rest_state(mesh);
    EXPECT_EQ(rest.edge.rows(), 8);
    EXPECT_EQ(rest.hinge.rows(), 1);
    EXPECT_NEAR(rest.mass[5], 2.0, 1e-15);
    EXPECT_NEAR(rest.mass[4], (1 + 3 + 6) / 7.0, 1e-14);  // the mean of the seven that have triangles
}

TEST(RestState, vertices_alone_make_a_mesh) {
    ClothMesh mesh;
    mesh.rest_position = Positions::Zero(2, 3);
    const RestState rest = rest_state(mesh);
    EXPECT_EQ(rest.edge.rows(), 0);
    EXPECT_EQ(rest.hinge.rows(), 0);
    EXPECT_EQ(rest.mass, Eigen::Vector2d(1, 1));
}

TEST(RestState, given_masses_are_kept) {
    ClothMesh mesh = folded();
    mesh.rest_position.conservativeResize(6, 3);
    mesh.rest_position.bottomRows(2).setZero();
    mesh.mass.resize(6);
    mesh.mass << 1e-12, 2, 3, 4, 5, 0;
    Eigen::VectorXd expected = mesh.mass;
    expected[5] = mesh.mass.sum() / 5;  // no triangle and no mass: the mean of the others
    EXPECT_TRUE(rest_state(mesh).mass.isApprox(expected, 1e-15));
}

TEST(RestState, a_triangle_without_area_is_unfolded_to_a_line) {
    ClothMesh mesh = folded();
    mesh.rest_position.row(2) << 0.5, 0, 0;
    const RestState flat = rest_state(mesh);
    EXPECT_NEAR(flat.hinge_rest_length[0], std::hypot(0.5, 3.0), 1e-7);
    EXPECT_NEAR(flat.hinge_crossing(0, 1), 0.0, 1e-7);
    EXPECT_NEAR(flat.mass[2], (1.0 + 1.0 + 1.0) / 3, 1e-12);
    mesh.rest_position.row(3) << 1.5, 0, 0;
    const RestState line = rest_state(mesh);
    EXPECT_NEAR(line.hinge_rest_length[0], 1.0, 1e-7);
    EXPECT_TRUE(line.hinge_crossing.allFinite());
    EXPECT_EQ(line.mass, Eigen::VectorXd::Ones(4));
}

TEST(RestState, lengths_scale_with_the_unit) {
    ClothMesh mesh = folded();
    const RestState metres = rest_state(mesh);
    mesh.rest_position *= 1e-3;
    const RestState millimetres = rest_state(mesh);
    EXPECT_TRUE(millimetres.edge_rest_length.isApprox(1e-3 * metres.edge_rest_length, 1e-14));
    EXPECT_TRUE(millimetres.hinge_rest_length.isApprox(1e-3 * metres.hinge_rest_length, 1e-14));
    EXPECT_TRUE(millimetres.hinge_crossing.isApprox(metres.hinge_crossing, 1e-14));
    EXPECT_TRUE(millimetres.mass.isApprox(1e-6 * metres.mass, 1e-14));
}

TEST(RestState, refuses_a_mesh_without_vertices) {
    EXPECT_THAT(refusal(ClothMesh{}), HasSubstr("no vertices"));
}

TEST(RestState, refuses_indices_out_of_range) {
    ClothMesh mesh = folded();
    mesh.triangle(1, 2) = 4;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 1 refers to vertex 4 of 4"));
    mesh.triangle(1, 2) = -1;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 1 refers to vertex -1"));
    mesh = with_pattern();
    mesh.pattern_triangle(1, 1) = 6;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 1 refers to pattern position 6 of 6"));
}

TEST(RestState, refuses_positions_that_are_not_finite) {
    ClothMesh mesh = folded();
    mesh.rest_position(3, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(mesh), HasSubstr("vertex 3 is not finite"));
    mesh = with_pattern();
    mesh.pattern_position(2, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(mesh), HasSubstr("pattern position 2 is not finite"));
}

TEST(RestState, refuses_lengths_beyond_the_numbers) {
    ClothMesh mesh = folded();
    mesh.rest_position(3, 1) = 1e200;
    EXPECT_THAT(refusal(mesh), HasSubstr("edge (0, 3) is too long"));
}

TEST(RestState, refuses_a_triangle_that_uses_a_vertex_twice) {
    ClothMesh mesh = folded();
    mesh.triangle(1, 2) = 0;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 1 uses one vertex twice"));
}

TEST(RestState, refuses_an_edge_without_length) {
    ClothMesh mesh = folded();
    mesh.rest_position.row(3) = mesh.rest_position.row(1);
    EXPECT_THAT(refusal(mesh), HasSubstr("edge (1, 3) has no length at rest"));
    mesh = with_pattern();
    mesh.pattern_triangle(0, 2) = 1;
    EXPECT_THAT(refusal(mesh), HasSubstr("edge (1, 2) has no length at rest"));
}

TEST(RestState, refuses_masses_that_make_no_sense) {
    ClothMesh mesh = folded();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [bad, word] : {std::pair{-1.0, "negative"}, {nan, "not finite"}, {0.0, "zero"}}) {
        mesh.mass = Eigen::Vector4d(1, 2, bad, 4);
        EXPECT_THAT(refusal(mesh), HasSubstr(std::string("the mass of vertex 2 is ") + word));
    }
    mesh.mass = Eigen::Vector3d(1, 2, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("4 vertices but 3 masses"));
}

TEST(RestState, refuses_a_pattern_that_does_not_fit) {
    ClothMesh mesh = with_pattern();
    mesh.pattern_triangle.conservativeResize(1, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("2 triangles but 1 pattern triangles"));
    mesh.pattern_triangle.resize(0, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("2 triangles but 0 pattern triangles"));
}

TEST(RestState, refuses_an_edge_of_countless_triangles) {
    ClothMesh mesh = folded();
    mesh.rest_position.conservativeResize(103, 3);
    mesh.triangle.resize(101, 3);
    for (int f = 0; f < 101; ++f) {
        mesh.rest_position.row(f + 2) << 1, 1, 0.1 * f;
        mesh.triangle.row(f) << 0, 1, f + 2;
    }
    EXPECT_THAT(refusal(mesh), HasSubstr("edge (0, 1) belongs to 101 triangles"));
    mesh.triangle.conservativeResize(100, 3);
    EXPECT_EQ(rest_state(mesh).hinge.rows(), 100 * 99 / 2);
}

}  // namespace
}  // namespace toile::prior
