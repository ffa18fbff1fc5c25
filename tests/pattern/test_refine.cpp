#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/refine.h"
#include "pattern/settle.h"
#include "tests/pattern/two_panels.h"

namespace toile::pattern {
namespace {

Garment coarse() {
    const TwoPanels panels = two_panels(3);
    Garment garment;
    garment.mesh = panels.mesh;
    garment.triangle_panel = panels.triangle_panel;
    garment.panel_name = {"one", "two"};
    return garment;
}

double smallest_angle(const ClothMesh& mesh) {
    double smallest = std::numbers::pi;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d at = mesh.pattern_position.row(mesh.pattern_triangle(f, k));
            const Eigen::RowVector2d u = mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 1) % 3)) - at;
            const Eigen::RowVector2d v = mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 2) % 3)) - at;
            smallest = std::min(smallest, std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v)));
        }
    }
    return smallest;
}

double pattern_area(const ClothMesh& mesh) {
    return lumped_mass(mesh, 1.0).sum();
}

TEST(Refine, divides_until_no_edge_is_longer) {
    const Garment start = coarse();
    for (double target : {0.05, 0.02, 0.007}) {
        Garment garment = start;
        refine(garment, target);
        EXPECT_NO_THROW(check_cloth_mesh(garment.mesh, ""));
        EXPECT_LE(pattern_edge_lengths(garment.mesh).maxCoeff(), target);
        EXPECT_GT(pattern_edge_lengths(garment.mesh).mean(), 0.3 * target);
        EXPECT_NEAR(pattern_area(garment.mesh), pattern_area(start.mesh), 1e-12);
        EXPECT_GT(smallest_angle(garment.mesh), 0.5 * smallest_angle(start.mesh));
        EXPECT_EQ(boundary_loops(garment.mesh.triangle).size(), 1u);
    }
}

TEST(Refine, keeps_seams_sewn_and_panels_apart) {
    Garment garment = coarse();
    refine(garment, 0.02);
    ASSERT_EQ(garment.triangle_panel.size(), static_cast<size_t>(garment.mesh.triangle_count()));
    // Seam vertices have two pattern positions, at one height: x = 0.2 in space is u = 0.2 and u = 0.35.
    int seam_corners = 0;
    for (int f = 0; f < garment.mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const auto place = garment.mesh.rest_position.row(garment.mesh.triangle(f, k));
            const auto flat = garment.mesh.pattern_position.row(garment.mesh.pattern_triangle(f, k));
            EXPECT_NEAR(place[1], flat[1], 1e-12);
            EXPECT_NEAR(place[0] + 0.15 * garment.triangle_panel[f], flat[0], 1e-12);
            seam_corners += std::abs(place[0] - 0.2) < 1e-12;
        }
    }
    EXPECT_GT(seam_corners, 20);
}

TEST(Refine, leaves_a_fine_garment_alone) {
    Garment garment = coarse();
    refine(garment, 1.0);
    EXPECT_EQ(garment.mesh.triangle, coarse().mesh.triangle);
    EXPECT_EQ(garment.mesh.rest_position, coarse().mesh.rest_position);
}

TEST(Refine, refuses_to_make_too_many) {
    Garment garment = coarse();
    EXPECT_THROW(refine(garment, 0.001, 1000), Error);
}

}  // namespace
}  // namespace toile::pattern
