#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "simulate/body_intersection.h"
#include "skin/surface_extraction.h"

namespace toile::simulate {
namespace {

constexpr double radius = 0.1;

/// Two balls, their centres `apart` [m] from each other along x.
skin::Body two_balls(double apart) {
    const auto ball = skin::extract_surface([](const Eigen::Vector3d& p) { return p.norm() - radius; },
                                            Eigen::Vector3d::Constant(-0.15), Eigen::Vector3d::Constant(0.15), 0.01);
    const auto vertices = static_cast<int>(ball.position.rows());
    skin::Body body;
    body.rest_position.resize(2 * vertices, 3);
    body.rest_position << ball.position, ball.position.rowwise() + Eigen::RowVector3d(apart, 0, 0);
    body.triangle.resize(2 * ball.triangle.rows(), 3);
    body.triangle << ball.triangle, ball.triangle.array() + vertices;
    return body;
}

/// The tip of one ball lies this deep below the joined surface, whose nearest point is on the circle where they meet.
double lens_depth(double apart) {
    const double overlap = 2 * radius - apart;
    return std::hypot(0.5 * overlap, std::sqrt(radius * radius - 0.25 * apart * apart));
}

const Positions near = Eigen::RowVector3d(0.06, 0.1, 0.0);

TEST(BodyIntersection, IsNoneWhereNothingMeets) {
    const skin::Body body = two_balls(0.25);
    const BodyIntersection found = body_self_intersection(body, two_balls(0.21).rest_position, near);
    EXPECT_EQ(found.crossings, 0);
    EXPECT_EQ(found.depth, 0.0);
}

TEST(BodyIntersection, MeasuresHowDeepOnePartLiesInTheOther) {
    const skin::Body body = two_balls(0.25);
    for (const double apart : {0.17, 0.15, 0.12}) {
        const BodyIntersection found = body_self_intersection(body, two_balls(apart).rest_position, near);
        EXPECT_GT(found.crossings, 10);
        EXPECT_NEAR(found.depth, lens_depth(apart), 0.01) << apart;
        EXPECT_NEAR(found.place.y(), 0.0, 0.015);
    }
}

TEST(BodyIntersection, FarFromTheGarmentDoesNotMatter) {
    const skin::Body body = two_balls(0.25);
    const Positions far = near.rowwise() + Eigen::RowVector3d(0, 0.5, 0);
    const BodyIntersection found = body_self_intersection(body, two_balls(0.15).rest_position, far);
    EXPECT_GT(found.crossings, 10);
    EXPECT_EQ(found.depth, 0.0);
}

TEST(BodyIntersection, WhatIntersectsInTheNeutralPoseIsNotCounted) {
    const skin::Body body = two_balls(0.15);
    EXPECT_EQ(body_self_intersection(body, body.rest_position, near).crossings, 0);
    const Positions turned = body.rest_position * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).matrix().transpose();
    EXPECT_EQ(body_self_intersection(body, turned, near).depth, 0.0);
}

TEST(BodyIntersection, CountsPairsOfTrianglesThatMeet) {
    Positions a(3, 3), b(3, 3);
    a << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    b << 0.2, 0.2, -1, 0.3, 0.2, 1, 0.2, 0.3, 1;
    Triangles one(1, 3);
    one << 0, 1, 2;
    EXPECT_EQ(count_crossing_pairs(one, a, one, b), 1);
    EXPECT_EQ(count_crossing_pairs(one, a, one, b.rowwise() + Eigen::RowVector3d(0, 0, 1.1)), 0);
    EXPECT_EQ(count_crossing_pairs(one, a, one, Positions::Constant(3, 3, 0.1)), 0) << "a triangle without area";
    b(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(count_crossing_pairs(one, a, one, b), Error);
}

}  // namespace
}  // namespace toile::simulate
