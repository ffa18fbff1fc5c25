#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/patch.h"

namespace toile::pattern {
namespace {

TEST(Patch, hangs_flat_and_at_rest) {
    PatchOptions options;
    options.width = 0.6;
    options.height = 0.4;
    options.edge_length = 0.04;
    const Garment patch = make_patch(options);
    const ClothMesh& mesh = patch.mesh;
    EXPECT_NO_THROW(check_cloth_mesh(mesh, ""));
    EXPECT_EQ(boundary_loops(mesh.triangle).size(), 1u);
    EXPECT_NEAR(mesh.rest_position.col(1).maxCoeff(), 0.0, 1e-12);
    EXPECT_NEAR(mesh.rest_position.col(1).minCoeff(), -0.4, 1e-12);
    EXPECT_NEAR(mesh.rest_position.col(0).maxCoeff(), 0.3, 1e-12);
    EXPECT_TRUE(mesh.rest_position.col(2).isZero(0.0));
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(
                (mesh.rest_position.row(mesh.triangle(f, k)) - mesh.rest_position.row(mesh.triangle(f, (k + 1) % 3)))
                    .norm(),
                (mesh.pattern_position.row(mesh.pattern_triangle(f, k)) -
                 mesh.pattern_position.row(mesh.pattern_triangle(f, (k + 1) % 3)))
                    .norm(),
                1e-12);
    EXPECT_GT(vertex_normals(mesh.triangle, mesh.rest_position).col(2).minCoeff(), 0.99);
    EXPECT_NEAR(mesh.vertex_count(), 1.15 * 0.24 / (0.04 * 0.04), 40);
}

TEST(Patch, lies_facing_up) {
    PatchOptions options;
    options.edge_length = 0.1;
    options.orientation = PatchOrientation::horizontal;
    const Garment patch = make_patch(options);
    EXPECT_TRUE(patch.mesh.rest_position.col(1).isZero(0.0));
    EXPECT_GT(vertex_normals(patch.mesh.triangle, patch.mesh.rest_position).col(1).minCoeff(), 0.99);
    EXPECT_NEAR(patch.mesh.rest_position.col(2).minCoeff(), -0.5, 1e-12);
}

TEST(Patch, refuses_options_out_of_range) {
    for (auto spoil : {+[](PatchOptions& o) { o.width = 0.0; }, +[](PatchOptions& o) { o.height = -1.0; },
                       +[](PatchOptions& o) { o.edge_length = 0.0; }, +[](PatchOptions& o) { o.edge_length = 0.6; },
                       +[](PatchOptions& o) { o.width = std::numeric_limits<double>::quiet_NaN(); }}) {
        PatchOptions options;
        spoil(options);
        EXPECT_THROW(make_patch(options), Error);
    }
}

}  // namespace
}  // namespace toile::pattern
