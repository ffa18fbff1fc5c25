#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cloth/cloth_mesh.h"
#include "cloth/error.h"

namespace toile {
namespace {

/// Two panels of two triangles each, sewn along x = 1: six vertices, eight pattern positions, 1 m by 2 m.
ClothMesh two_panels() {
    ClothMesh mesh;
    mesh.rest_position.resize(6, 3);
    mesh.rest_position << 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0;
    mesh.pattern_position.resize(8, 2);
    mesh.pattern_position << 0, 0, 0, 1, 1, 0, 1, 1, 5, 0, 5, 1, 6, 0, 6, 1;
    mesh.triangle.resize(4, 3);
    mesh.triangle << 0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5;
    mesh.pattern_triangle.resize(4, 3);
    mesh.pattern_triangle << 0, 2, 1, 1, 2, 3, 4, 6, 5, 5, 6, 7;
    return mesh;
}

/// The message of the refusal of `mesh`, empty where it is accepted.
std::string refusal(const ClothMesh& mesh) {
    try {
        check_cloth_mesh(mesh, "shirt.obj");
    } catch (const Error& error) {
        EXPECT_EQ(error.where(), "shirt.obj");
        return error.what();
    }
    return {};
}

using testing::HasSubstr;

TEST(ClothMesh, sound_mesh_is_accepted) {
    EXPECT_EQ(refusal(two_panels()), "");
}

TEST(ClothMesh, no_triangles) {
    ClothMesh mesh = two_panels();
    mesh.triangle.resize(0, 3);
    mesh.pattern_triangle.resize(0, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("no triangles"));
}

TEST(ClothMesh, pattern_of_another_length) {
    ClothMesh mesh = two_panels();
    mesh.pattern_triangle.conservativeResize(3, 3);
    EXPECT_THAT(refusal(mesh), HasSubstr("4 triangles but 3 pattern triangles"));
}

TEST(ClothMesh, position_that_is_not_a_number) {
    ClothMesh mesh = two_panels();
    mesh.rest_position(4, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(mesh), HasSubstr("vertex 4 is not finite"));
}

TEST(ClothMesh, infinite_pattern_position) {
    ClothMesh mesh = two_panels();
    mesh.pattern_position(7, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(mesh), HasSubstr("pattern position 7 is not finite"));
}

TEST(ClothMesh, index_out_of_range) {
    ClothMesh mesh = two_panels();
    mesh.triangle(2, 1) = 6;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 2 refers to vertex 6 of 6"));
    mesh.triangle(2, 1) = -1;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 2 refers to vertex -1"));
}

TEST(ClothMesh, pattern_index_out_of_range) {
    ClothMesh mesh = two_panels();
    mesh.pattern_triangle(3, 2) = 8;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 3 refers to pattern position 8 of 8"));
}

TEST(ClothMesh, repeated_vertex) {
    ClothMesh mesh = two_panels();
    mesh.triangle(1, 2) = 1;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 1 uses one vertex twice"));
}

TEST(ClothMesh, isolated_vertex) {
    ClothMesh mesh = two_panels();
    mesh.rest_position.conservativeResize(7, 3);
    mesh.rest_position.row(6).setZero();
    EXPECT_THAT(refusal(mesh), HasSubstr("vertex 6 belongs to no triangle"));
}

TEST(ClothMesh, edge_of_three_triangles) {
    ClothMesh mesh = two_panels();
    mesh.rest_position.conservativeResize(7, 3);
    mesh.rest_position.row(6) << 1, 0.5, 1;
    mesh.triangle.conservativeResize(5, 3);
    mesh.triangle.row(4) << 2, 3, 6;
    mesh.pattern_triangle.conservativeResize(5, 3);
    mesh.pattern_triangle.row(4) << 4, 6, 5;
    EXPECT_THAT(refusal(mesh), HasSubstr("edge (2, 3) belongs to more than two triangles"));
}

TEST(ClothMesh, winding_turned_over) {
    ClothMesh mesh = two_panels();
    mesh.triangle.row(3) << 3, 5, 4;
    mesh.pattern_triangle.row(3) << 5, 7, 6;
    EXPECT_THAT(refusal(mesh), HasSubstr("wound against each other"));
}

TEST(ClothMesh, triangle_without_area) {
    ClothMesh mesh = two_panels();
    mesh.rest_position.row(0) << 1, 2, 0;
    mesh.rest_position.row(1) << 1, 3, 0;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 0 has no area"));
}

TEST(ClothMesh, triangle_without_pattern_area) {
    ClothMesh mesh = two_panels();
    mesh.pattern_position.row(4) << 6, 0.5;
    mesh.pattern_position.row(5) << 6, 2;
    EXPECT_THAT(refusal(mesh), HasSubstr("triangle 2 has no area in the pattern"));
}

TEST(ClothMesh, mass_follows_the_pattern_not_space) {
    ClothMesh mesh = two_panels();
    mesh.rest_position *= 3.0;
    const Eigen::VectorXd mass = lumped_mass(mesh, 0.2);
    EXPECT_NEAR(mass.sum(), 0.2 * 2.0, 1e-15);
    EXPECT_NEAR(mass[0], 0.2 * 0.5 / 3, 1e-15);  // in one triangle
    EXPECT_NEAR(mass[3], 0.2 * 1.5 / 3, 1e-15);  // in three triangles, of both panels
}

}  // namespace
}  // namespace toile
