#include <gtest/gtest.h>

#include "cloth/topology.h"
#include "simulate/collision_body.h"
#include "skin/pillar_body.h"
#include "skin/surface_query.h"

namespace toile::simulate {
namespace {

const LevelSetOptions options{0.006, 0.001};

ReachableSurface whole(const skin::Body& body) {
    return reachable_surface(body.triangle, body.rest_position, body.rest_position, 0.2);
}

void start(CollisionBody& collision, const skin::Body& body) {
    collision.start(skin::bent_pillar(0.0), std::make_shared<const BodyLevelSet>(
                                                body, body.rest_position, body.rest_position, options.voxel, 0.002));
}

TEST(ReachableSurface, KeepsAClosedBodyWholeAndCapsACutOne) {
    const skin::Body body = skin::pillar_body();
    const ReachableSurface all = whole(body);
    EXPECT_EQ(all.triangle.rows(), body.triangle.rows());
    EXPECT_TRUE(all.cap.empty());

    Positions cloth(1, 3);
    cloth << 0.0, 1.0, 0.0;
    const ReachableSurface top = reachable_surface(body.triangle, body.rest_position, cloth, 0.2);
    EXPECT_LT(top.share, 0.8);
    ASSERT_EQ(top.cap.size(), 1u);
    EXPECT_TRUE(boundary_loops(top.triangle).empty()) << "the cut is closed";
    EXPECT_EQ(top.positions(body.rest_position).rows(), body.vertex_count() + 1);
}

TEST(ReachableSurface, ClosesABodyThatIsOpen) {
    skin::Body body = skin::pillar_body();
    const Triangles open = body.triangle.topRows(body.triangle.rows() - 1);
    body.triangle = open;
    EXPECT_TRUE(boundary_loops(whole(body).triangle).empty());
}

TEST(CollisionBody, DistanceIsToThePosedMesh) {
    const skin::Body body = skin::pillar_body();
    CollisionBody collision(body, skin::SkinningMethod::linear, options, 0.002);
    DrapeReport report;
    start(collision, body);
    collision.move_to(skin::bent_pillar(0.6), report);
    collision.fit_level_set(true, collision.position(), report);
    const skin::SurfaceQuery query(body.triangle, collision.position());
    for (int v = 0; v < body.vertex_count(); v += 37) {
        const Eigen::Vector3d point = collision.position().row(v).transpose() + Eigen::Vector3d(0.001, 0.002, -0.001);
        const double expected = query.nearest(point).signed_distance;
        EXPECT_NEAR(collision.distance(point, v), expected, 0.0006) << "vertex " << v;
    }
    EXPECT_EQ(report.level_sets, 1);
}

TEST(CollisionBody, ACarriedLevelSetStaysWithinItsBound) {
    const skin::Body body = skin::pillar_body();
    CollisionBody collision(body, skin::SkinningMethod::linear, options, 0.002);
    DrapeReport report;
    start(collision, body);
    std::vector<int> piece(static_cast<size_t>(body.vertex_count()));
    for (int k = 1; k <= 20; ++k) {
        for (int v = 0; v < body.vertex_count(); ++v)
            piece[v] = collision.piece_near(collision.position().row(v).transpose(), v);
        collision.move_to(skin::bent_pillar(0.05 * k), report);
        collision.fit_level_set(false, collision.position(), report);
        for (int v = 0; v < body.vertex_count(); v += 29) {
            const Eigen::Vector3d on_surface = collision.position().row(v).transpose();
            // Three times the bound on the way, and twice the coarser path grid's own smoothing.
            EXPECT_NEAR(collision.distance(on_surface, piece[v]), 0.0, 3.0 * options.error_bound + 0.002)
                << k << ": " << v;
        }
    }
    EXPECT_GT(report.level_sets, 0);
    EXPECT_LT(report.level_sets, 20) << "some steps are carried";
}

TEST(CollisionBody, AnchorsMoveWithTheSurface) {
    const skin::Body body = skin::pillar_body();
    CollisionBody collision(body, skin::SkinningMethod::linear, options, 0.002);
    DrapeReport report;
    start(collision, body);
    int top = 0;
    body.rest_position.col(1).maxCoeff(&top);
    const Eigen::Vector3d start = body.rest_position.row(top).transpose() + Eigen::Vector3d(0, 0.003, 0);
    const Eigen::Vector3d local = collision.to_local(start, top);
    EXPECT_LT((collision.to_world(local, top) - start).norm(), 1e-12);
    collision.move_to(skin::bent_pillar(0.5), report);
    // The top follows the upper joint rigidly.
    const Eigen::Vector3d pivot(0, 0.5, 0);
    const Eigen::Vector3d expected = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) * (start - pivot) + pivot;
    EXPECT_LT((collision.to_world(local, top) - expected).norm(), 1e-9);
    EXPECT_LT((collision.carry(start, top) - expected).norm(), 1e-9);
}

}  // namespace
}  // namespace toile::simulate
