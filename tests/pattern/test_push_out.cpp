#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/patch.h"
#include "pattern/push_out.h"
#include "tests/pattern/tube_garment.h"

namespace toile::pattern {
namespace {

/// A flat cloth in front of a column of radius 0.1, `depth` behind its foremost line.
struct Scene {
    skin::Body body = column_body(0.1, -1.0, 1.0, 64, 40);
    skin::SurfaceQuery query = {body.triangle, body.rest_position};
    ClothMesh cloth;
    explicit Scene(double depth) {
        cloth = make_patch({.width = 0.4, .height = 0.4, .edge_length = 0.02}).mesh;
        cloth.rest_position.col(2).array() += 0.1 - depth;
    }
};

TEST(PushOut, every_vertex_comes_clear_and_none_is_left_behind) {
    Scene scene(0.03);
    const Positions start = scene.cloth.rest_position;
    const PushOutReport report =
        push_out(scene.cloth.triangle, scene.cloth.rest_position, scene.query, {.clearance = 0.005}, "cloth");
    EXPECT_NEAR(report.deepest, 0.03, 0.001);
    EXPECT_GT(report.inside, 50);
    EXPECT_EQ(report.still_near, 0);
    for (int v = 0; v < start.rows(); ++v)
        EXPECT_GT(scene.query.nearest(scene.cloth.rest_position.row(v)).signed_distance, 0.0048) << v;
    // Neighbours follow: the step between two of them stays within their distance.
    const Edges edge = build_topology(scene.cloth.triangle).edge;
    const Positions move = scene.cloth.rest_position - start;
    for (int e = 0; e < edge.rows(); ++e) EXPECT_LT((move.row(edge(e, 0)) - move.row(edge(e, 1))).norm(), 0.03);
    EXPECT_EQ(report.moved, ((move.rowwise().norm().array() > 1e-4).count()));
}

TEST(PushOut, what_is_clear_stays) {
    Scene scene(-0.02);
    const Positions start = scene.cloth.rest_position;
    const PushOutReport report =
        push_out(scene.cloth.triangle, scene.cloth.rest_position, scene.query, {.clearance = 0.005}, "cloth");
    EXPECT_EQ(report.inside, 0);
    EXPECT_EQ(report.moved, 0);
    EXPECT_EQ(scene.cloth.rest_position, start);
}

TEST(PushOut, refuses_what_is_too_deep) {
    Scene scene(0.06);
    try {
        push_out(scene.cloth.triangle, scene.cloth.rest_position, scene.query, {.max_push = 0.05}, "cloth.obj");
        FAIL() << "was accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("does not fit the body"));
        EXPECT_EQ(error.where(), "cloth.obj");
    }
}

}  // namespace
}  // namespace toile::pattern
