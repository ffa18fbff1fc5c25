#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "prior/second_order_cone.h"

namespace toile::prior {
namespace {

/// A point inside the cone; the smaller `depth`, the nearer to its boundary.
ConePoint point_inside(std::mt19937& random, double depth) {
    std::normal_distribution<double> normal;
    ConePoint q(0.0, normal(random), normal(random), normal(random));
    q[0] = (1.0 + depth) * q.tail<3>().norm();
    return q;
}

Eigen::Matrix4d product_matrix(const ConePoint& q) {
    Eigen::Matrix4d matrix = q[0] * Eigen::Matrix4d::Identity();
    matrix.block<1, 3>(0, 1) = q.tail<3>().transpose();
    matrix.block<3, 1>(1, 0) = q.tail<3>();
    return matrix;
}

TEST(SecondOrderCone, MultipliesAsThePaperDefinesIt) {
    const ConePoint q(2, 1, 0, -1), p(3, 0, 4, 1);
    EXPECT_EQ(cone_product(q, p), ConePoint(5, 3, 8, -1));
    EXPECT_EQ(cone_product(q, p), cone_product(p, q));
    EXPECT_DOUBLE_EQ(cone_determinant(q), 2.0);
}

TEST(SecondOrderCone, DividesWhatItMultiplied) {
    std::mt19937 random(1);
    for (double depth : {1.0, 1e-3, 1e-6}) {
        const ConePoint q = point_inside(random, depth), x = ConePoint::Random();
        EXPECT_LT((cone_divide(q, cone_product(q, x)) - x).norm(), 1e-14 / depth);
    }
}

TEST(SecondOrderCone, StepsToTheBoundary) {
    const ConePoint q(2, 0, 0, 0);
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {0, 1, 0, 0}, 10), 2.0);
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {-1, 0, 0, 0}, 10), 2.0);
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {-1, 1, 0, 0}, 10), 1.0);
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {1, 1, 0, 0}, 10), 10.0);  // along the boundary
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {1, 0, 0, 0}, 10), 10.0);  // inwards
    EXPECT_DOUBLE_EQ(step_to_boundary(q, {0, 1, 0, 0}, 0.5), 0.5);
    std::mt19937 random(2);
    for (int k = 0; k < 100; ++k) {
        const ConePoint start = point_inside(random, 1e-2), change = ConePoint::Random();
        const double step = step_to_boundary(start, change, 1e3);
        EXPECT_GT(cone_determinant(start + 0.999 * step * change), 0.0);
        EXPECT_GT(start[0] + 0.999 * step * change[0], 0.0);
        if (step < 1e3) {
            EXPECT_LT(cone_determinant(start + 1.001 * step * change), 0.0);
        }
    }
}

TEST(ConeScaling, MapsBothPointsToOne) {
    std::mt19937 random(3);
    for (double depth : {1.0, 1e-3, 1e-6})
        for (int k = 0; k < 20; ++k) {
            const ConePoint s = point_inside(random, depth), z = point_inside(random, depth);
            const ConeScaling w = ConeScaling::of(s, z);
            EXPECT_LT((w.apply(z) - w.unapply(s)).norm(), 1e-15 / depth * w.apply(z).norm());
            EXPECT_LT((w.unapply(w.apply(z)) - z).norm(), 1e-15 / depth * z.norm());
            EXPECT_NEAR(w.apply(z).squaredNorm(), s.dot(z), 1e-14 / depth * s.dot(z));
        }
}

TEST(ConeScaling, IsAMultipleOfTheIdentityAndOneRank) {
    std::mt19937 random(4);
    const ConePoint s = point_inside(random, 0.1), z = point_inside(random, 0.1);
    const ConeScaling w = ConeScaling::of(s, z);
    Eigen::Matrix4d matrix;
    for (int c = 0; c < 4; ++c) matrix.col(c) = w.apply(ConePoint::Unit(c));
    EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-14);
    const Eigen::Matrix3d expected = (Eigen::Matrix3d::Identity() + 2.0 * w.w1 * w.w1.transpose()) / (w.eta * w.eta);
    EXPECT_LT(((matrix * matrix).inverse().bottomRightCorner<3, 3>() - expected).norm(), 1e-12 * expected.norm());
    EXPECT_LT((product_matrix(s) * z - cone_product(s, z)).norm(), 1e-14);
}

}  // namespace
}  // namespace toile::prior
