#include <gtest/gtest.h>

#include "pattern/garment_file.h"
#include "pattern/settle.h"
#include "skin/surface_query.h"
#include "tests/pattern/tube_garment.h"

namespace toile::pattern {
namespace {

ClothMesh tube() {
    return garment_from_mesh(tube_garment(), {}, nullptr, "tube").mesh;
}

TEST(Settle, stretched_cloth_comes_back_to_its_pattern) {
    ClothMesh mesh = tube();
    mesh.rest_position.col(0) *= 1.3;
    mesh.rest_position.col(1) *= 0.8;
    const SettleReport report = settle(mesh, column_body(0.17, -0.2, 0.6), {.clearance = 0.008});
    EXPECT_LT(report.max_stretch, 1.1);
    EXPECT_GT(report.min_stretch, 0.85);
    EXPECT_GT(report.nearest, 0.006);
}

TEST(Settle, cloth_inside_comes_out_though_the_body_is_open) {
    skin::Body body = column_body(0.17, -0.2, 0.6);
    for (bool open : {false, true}) {
        if (open) {  // without its ends
            Triangles side(body.triangle.rows(), 3);
            int count = 0;
            for (int f = 0; f < body.triangle.rows(); ++f)
                if (body.triangle.row(f).maxCoeff() < body.vertex_count() - 2) side.row(count++) = body.triangle.row(f);
            ASSERT_LT(count, body.triangle.rows());
            body.triangle = side.topRows(count);
        }
        ClothMesh mesh = tube();
        mesh.rest_position.col(0).array() += 0.06;  // one side 3 cm inside
        const SettleReport report = settle(mesh, body, {.clearance = 0.008});
        EXPECT_GT(report.nearest, 0.006) << open;
        const skin::SurfaceQuery query(body.triangle, body.rest_position);
        for (int v = 0; v < mesh.vertex_count(); ++v)
            EXPECT_GT(query.nearest(mesh.rest_position.row(v)).signed_distance, 0.006) << open;
        EXPECT_LT(report.max_stretch, 1.2);
    }
}

TEST(Settle, pattern_lengths_are_means_over_the_sides_of_a_seam) {
    ClothMesh mesh;
    mesh.rest_position.resize(4, 3);
    mesh.rest_position << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0;
    mesh.triangle.resize(2, 3);
    mesh.triangle << 0, 1, 2, 2, 1, 3;
    mesh.pattern_position.resize(6, 2);
    mesh.pattern_position << 0, 0, 3, 0, 0, 4, 10, 0, 16, 0, 10, 8;
    mesh.pattern_triangle.resize(2, 3);
    mesh.pattern_triangle << 0, 1, 2, 5, 4, 3;
    const Eigen::VectorXd length = pattern_edge_lengths(mesh);
    ASSERT_EQ(length.size(), 5);
    EXPECT_EQ(length[0], 3.0);                 // (0, 1)
    EXPECT_EQ(length[2], 0.5 * (5.0 + 10.0));  // (1, 2), the seam
}

}  // namespace
}  // namespace toile::pattern
