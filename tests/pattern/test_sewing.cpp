#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/sewing.h"

namespace toile::pattern {
namespace {

PanelSide side(const char* name, const Eigen::RowVector2d& from, const Eigen::RowVector2d& to, int pieces) {
    PanelSide line = {name, PlanePositions(pieces + 1, 2)};
    for (int k = 0; k <= pieces; ++k) line.line.row(k) = from + (to - from) * k / pieces;
    line.line.row(pieces) = to;
    return line;
}

Panel square(const char* name, int pieces) {
    return {name,
            {side("bottom", {0, 0}, {1, 0}, pieces), side("right", {1, 0}, {1, 1}, pieces),
             side("top", {1, 1}, {0, 1}, pieces), side("left", {0, 1}, {0, 0}, pieces)}};
}

/// Two squares, the first's right sewn to the second's left.
struct Two {
    std::vector<Panel> panel = {square("one", 4), square("two", 4)};
    std::vector<PanelMesh> mesh;
    std::vector<Positions> position;
    Two() {
        for (int p = 0; p < 2; ++p) {
            mesh.push_back(mesh_panel(outline(panel[p]), 0.25));
            Positions place = Positions::Zero(mesh[p].position.rows(), 3);
            place.leftCols(2) = mesh[p].position;
            place.col(0).array() += 1.2 * p;  // 0.2 apart
            position.push_back(place);
        }
    }
};

TEST(Sewing, welds_a_seam_point_by_point) {
    const Two two;
    const Garment garment = sew(two.panel, two.mesh, {{0, 1, 1, 3}}, two.position, 0.1);
    const long points = two.mesh[0].position.rows() + two.mesh[1].position.rows();
    EXPECT_EQ(garment.mesh.vertex_count(), points - 5);
    EXPECT_EQ(garment.mesh.pattern_position.rows(), points);
    EXPECT_NO_THROW(check_cloth_mesh(garment.mesh, ""));
    EXPECT_EQ(boundary_loops(garment.mesh.triangle).size(), 1u);
    EXPECT_THAT(garment.panel_name, testing::ElementsAre("one", "two"));
    // What is welded went to the middle, corner to corner.
    const std::vector<int> right = side_points(two.panel[0], 1);
    for (int i : {0, 4}) {
        bool found = false;
        const Eigen::RowVector3d middle(1.1, two.mesh[0].position(right[i], 1), 0.0);
        for (int v = 0; v < garment.mesh.vertex_count(); ++v)
            found = found || (garment.mesh.rest_position.row(v) - middle).norm() < 1e-12;
        EXPECT_TRUE(found);
    }
}

TEST(Sewing, lays_panels_apart) {
    const Two two;
    const Garment garment = sew(two.panel, two.mesh, {}, two.position, 0.1);
    const long first = two.mesh[0].position.rows();
    EXPECT_NEAR(garment.mesh.pattern_position.col(0).head(first).maxCoeff() + 0.1,
                garment.mesh.pattern_position.col(0).tail(two.mesh[1].position.rows()).minCoeff(), 1e-12);
    EXPECT_NEAR(garment.mesh.pattern_position.col(1).minCoeff(), 0.0, 1e-12);
}

TEST(Sewing, joins_a_panel_to_itself) {
    const Panel strip = square("tube", 4);
    const PanelMesh mesh = mesh_panel(outline(strip), 0.25);
    Positions round(mesh.position.rows(), 3);
    for (int i = 0; i < round.rows(); ++i) {
        const double angle = 6.283185307179586 * mesh.position(i, 0);
        round.row(i) << 0.16 * std::cos(angle), mesh.position(i, 1), -0.16 * std::sin(angle);
    }
    const Garment tube = sew({strip}, {mesh}, {{0, 1, 0, 3}}, {round}, 0.0);
    EXPECT_EQ(boundary_loops(tube.mesh.triangle).size(), 2u);
    EXPECT_NO_THROW(check_cloth_mesh(tube.mesh, ""));
}

TEST(Sewing, refuses_sides_of_different_numbers) {
    Two two;
    two.panel[1] = square("two", 5);
    two.mesh[1] = mesh_panel(outline(two.panel[1]), 0.2);
    two.position[1] = Positions::Zero(two.mesh[1].position.rows(), 3);
    try {
        sew(two.panel, two.mesh, {{0, 1, 1, 3}}, two.position, 0.1);
        FAIL() << "was accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("joins 5 points to 6"));
    }
}

}  // namespace
}  // namespace toile::pattern
