#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "simulate/continuous_collision.h"
#include "tests/simulate/cloth_square.h"
#include "tests/simulate/random_points.h"

namespace toile::simulate {
namespace {

using Eigen::Vector3d;

FourPoints moved(const FourPoints& x, const FourPoints& motion, double share) {
    FourPoints now;
    for (int i = 0; i < 4; ++i) now[i] = x[i] + share * motion[i];
    return now;
}
FourPoints scaled(FourPoints x, double size, const Vector3d& place = Vector3d::Zero()) {
    for (auto& p : x) p = size * p + place;
    return x;
}

// The two kinds of pairs under one roof.
struct Kind {
    const char* name;
    double (*safe)(const FourPoints&, const FourPoints&, const SafeMotionOptions&, double);
    Proximity (*proximity)(const FourPoints&);
};
const Kind both[] = {{"vertex-triangle", vertex_triangle_safe_share, vertex_triangle_proximity},
                     {"edge-edge", edge_edge_safe_share, edge_edge_proximity}};

// Least distance on the way, at many moments.
double least_distance(const Kind& kind, const FourPoints& x, const FourPoints& motion, double share) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 60; ++i) least = std::min(least, kind.proximity(moved(x, motion, share * i / 60)).distance());
    return least;
}

TEST(ContinuousCollision, WhatIsSafeKeepsItsDistance) {
    test::RandomPoints random(1);
    int stopped = 0;
    for (int i = 0; i < 6000; ++i) {
        const double size = i % 3 == 0 ? 1e-3 : 1.0;
        const Vector3d place = i % 5 == 0 ? Vector3d(1000.0, -1000.0, 500.0) : Vector3d::Zero();
        const FourPoints x = scaled(random.four(i % test::RandomPoints::kinds), size, place);
        FourPoints motion = scaled(random.four((i / 8) % test::RandomPoints::kinds), size * random.number(0.01, 4.0));
        for (const Kind& kind : both) {
            SCOPED_TRACE(std::string(kind.name) + ' ' + std::to_string(i));
            const double start = kind.proximity(x).distance();
            const double share = kind.safe(x, motion, {}, 1.0);
            ASSERT_GE(share, 0.0);
            ASSERT_LE(share, 1.0);
            stopped += share < 1.0;
            EXPECT_GE(least_distance(kind, x, motion, share), 0.1 * start - 1e-15 * (size + place.norm()));
        }
    }
    EXPECT_GT(stopped, 1000);
}

TEST(ContinuousCollision, WhatMeetsIsStoppedBeforeButNotLongBefore) {
    // Made from the moment of meeting backwards: at `meeting` the nearest points coincide.
    test::RandomPoints random(2);
    for (int i = 0; i < 4000; ++i) {
        const double size = i % 3 == 0 ? 1e-3 : 1.0, meeting = random.number(0.1, 1.0);
        const Vector3d place = i % 5 == 0 ? Vector3d(1000.0, 0.0, -1000.0) : Vector3d::Zero();
        const FourPoints motion = scaled({random.point(), random.point(), random.point(), random.point()}, size);
        FourPoints touching = {random.point(), random.point(), random.point(), random.point()};
        const double s = random.number(0.0, 1.0), t = random.number(0.0, 1.0 - s);
        FourPoints triangle = touching, edges = touching;
        triangle[0] = (1.0 - s - t) * touching[1] + s * touching[2] + t * touching[3];
        edges[1] = touching[0] + ((1.0 - t) * touching[2] + t * touching[3] - touching[0]) / std::max(s, 0.05);
        for (const Kind& kind : both) {
            SCOPED_TRACE(std::string(kind.name) + ' ' + std::to_string(i));
            const FourPoints x =
                moved(scaled(kind.proximity == edge_edge_proximity ? edges : triangle, size, place), motion, -meeting);
            const double start = kind.proximity(x).distance();
            const double share = kind.safe(x, motion, {.steps = 1000}, 1.0);
            const bool meets = kind.proximity != edge_edge_proximity || s >= 0.05;
            if (meets) {
                EXPECT_LT(share, meeting);
            }
            const double left = kind.proximity(moved(x, motion, share)).distance();
            EXPECT_GE(left, 0.1 * start - 1e-15 * (size + place.norm()));
            if (share < 1.0) {
                EXPECT_LE(left, 0.16 * start);
            }
        }
    }
}

TEST(ContinuousCollision, AVertexThroughATriangle) {
    const FourPoints x = {Vector3d(0.25, 0.25, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    const FourPoints motion = {Vector3d(0, 0, -4), Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(0, 0, 0)};
    EXPECT_NEAR(vertex_triangle_safe_share(x, motion), 0.9 / 4.0, 1e-12);
    EXPECT_NEAR(vertex_triangle_safe_share(x, motion, {.remaining_share = 0.5}), 0.5 / 4.0, 1e-12);
    EXPECT_NEAR(vertex_triangle_safe_share(x, motion, {.separation = 0.5}), (0.5 - 0.05) / 4.0, 1e-12);
    EXPECT_NEAR(vertex_triangle_safe_share(x, motion, {.largest_remaining = 0.01}), 0.99 / 4.0, 1e-12);
    EXPECT_EQ(vertex_triangle_safe_share(x, motion, {}, 0.1), 0.1);
    EXPECT_EQ(vertex_triangle_safe_share(x, motion, {}, 0.0), 0.0);
}

TEST(ContinuousCollision, APairThatStartsNearerThanTheSeparationMayStillMove) {
    const FourPoints x = {Vector3d(0.25, 0.25, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    const FourPoints motion = {Vector3d(0, 0, -4), Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(0, 0, 0)};
    EXPECT_NEAR(vertex_triangle_safe_share(x, motion, {.separation = 2.0}), 0.9 / 4.0, 1e-12);
}

TEST(ContinuousCollision, AnEdgeThroughAnEdge) {
    const FourPoints x = {Vector3d(-1, 0, 1), Vector3d(1, 0, 1), Vector3d(0, -1, 0), Vector3d(0, 1, 0)};
    const FourPoints motion = {Vector3d(0, 0, -2), Vector3d(0, 0, -2), Vector3d(0, 0, 2), Vector3d(0, 0, 2)};
    EXPECT_NEAR(edge_edge_safe_share(x, motion), 0.9 / 4.0, 1e-12);
}

TEST(ContinuousCollision, PastAnEdgeByAHairIsNotStoppedShort) {
    // Grazing: the vertex passes 1e-6 beside the triangle's side.
    const FourPoints x = {Vector3d(0.5, -1e-6, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    const FourPoints motion = {Vector3d(0, 0, -2), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    const double share = vertex_triangle_safe_share(x, motion);
    EXPECT_LT(share, 0.5);
    EXPECT_GT(vertex_triangle_safe_share(x, motion, {.remaining_share = 1e-8}), 0.999);
}

TEST(ContinuousCollision, SlidingInOnePlaneGoesAsFarAsItCan) {
    const FourPoints x = {Vector3d(-1, 0, 0), Vector3d(-1, 1, 0), Vector3d(1, -5, 0), Vector3d(1, 5, 0)};
    FourPoints motion = {Vector3d(0, 9, 0), Vector3d(0, 9, 0), Vector3d::Zero(), Vector3d::Zero()};
    EXPECT_EQ(edge_edge_safe_share(x, motion), 1.0);
    motion[0] = motion[1] = Vector3d(4, 0, 0);
    EXPECT_NEAR(edge_edge_safe_share(x, motion), 0.45, 1e-12);
    // Along a triangle at a millionth of its size.
    const FourPoints above = {Vector3d(-3, 0.1, 1e-6), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    const FourPoints along = {Vector3d(6, 0, 0), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    EXPECT_NEAR(vertex_triangle_safe_share(above, along), 0.45, 1e-12);
    EXPECT_EQ(vertex_triangle_safe_share(above, along, {.largest_remaining = 1e-7}), 1.0);
}

TEST(ContinuousCollision, TouchingPairsStayWhereTheyAreUnlessTheyMoveTogether) {
    const FourPoints x = {Vector3d(0.25, 0.25, 0), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    const FourPoints motion = {Vector3d(0, 0, 1), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    EXPECT_EQ(vertex_triangle_safe_share(x, motion), 0.0);
    const FourPoints together = {Vector3d(0, 0, 1), Vector3d(0, 0, 1), Vector3d(0, 0, 1), Vector3d(0, 0, 1)};
    EXPECT_EQ(vertex_triangle_safe_share(x, together), 1.0);
}

TEST(ContinuousCollision, NumbersThatAreNoneAreNotSafe) {
    const FourPoints x = {Vector3d(0.25, 0.25, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    FourPoints motion = {Vector3d(0, 0, 1), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    EXPECT_EQ(vertex_triangle_safe_share(x, motion), 1.0);
    motion[2][1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(vertex_triangle_safe_share(x, motion), 0.0);
    motion[2][1] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(vertex_triangle_safe_share(x, motion), 0.0);
}

TEST(ContinuousCollision, FewStepsAreSafeToo) {
    test::RandomPoints random(3);
    for (int i = 0; i < 500; ++i) {
        const FourPoints x = random.four(0), motion = scaled(random.four(0), 3.0);
        double last = 0.0;
        for (const int steps : {0, 1, 2, 100}) {
            const double share = edge_edge_safe_share(x, motion, {.steps = steps});
            EXPECT_GE(share, last);
            last = share;
        }
        EXPECT_EQ(edge_edge_safe_share(x, motion, {.steps = 0}), 0.0);
    }
}

TEST(ContinuousCollision, ACrumplingSheetStopsBeforeItCrosses) {
    const ClothMesh mesh = test::cloth_square(10, 0.2, 0.0);
    const Edges edge = build_topology(mesh.triangle).edge;
    const Positions x = test::crumpled(mesh.rest_position, 2e-3);
    const Positions motion = test::crumpled(Positions::Zero(x.rows(), 3), 0.1);
    ContactCandidates candidates(mesh.triangle, edge);
    CandidatePairs pairs;
    candidates.find(x, motion, 0.0, pairs);
    const double share = safe_share(pairs, x, motion);
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0);
    // Over all pairs, not only the candidates: they must not have missed the first one.
    double all = 1.0;
    for (Eigen::Index a = 0; a < edge.rows(); ++a) {
        for (Eigen::Index b = a + 1; b < edge.rows(); ++b) {
            const std::array<int, 4> p = {edge(a, 0), edge(a, 1), edge(b, 0), edge(b, 1)};
            if (p[0] == p[2] || p[0] == p[3] || p[1] == p[2] || p[1] == p[3]) continue;
            all = edge_edge_safe_share(gather(x, p), gather(motion, p), {}, all);
        }
    }
    for (int v = 0; v < x.rows(); ++v) {
        for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f) {
            const std::array<int, 4> p = {v, mesh.triangle(f, 0), mesh.triangle(f, 1), mesh.triangle(f, 2)};
            if (v == p[1] || v == p[2] || v == p[3]) continue;
            all = vertex_triangle_safe_share(gather(x, p), gather(motion, p), {}, all);
        }
    }
    EXPECT_EQ(share, all);
    std::reverse(pairs.edge_edge.begin(), pairs.edge_edge.end());
    EXPECT_EQ(safe_share(pairs, x, motion), share);
}

}  // namespace
}  // namespace toile::simulate
