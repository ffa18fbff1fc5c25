#include <gtest/gtest.h>

#include <cmath>

#include "cloth/error.h"
#include "evaluate/position_projection.h"

namespace toile::evaluate {
namespace {

/// A chain of vertices along x, each edge with the limit 1.
PositionProjection chain(int vertices, const Eigen::VectorXd& stiffness) {
    Edges edge(vertices - 1, 2);
    for (int e = 0; e + 1 < vertices; ++e) edge.row(e) << e, e + 1;
    return PositionProjection(edge, Eigen::VectorXd::Ones(vertices - 1), stiffness);
}

Positions line(const std::vector<double>& x) {
    Positions position = Positions::Zero(static_cast<Eigen::Index>(x.size()), 3);
    for (size_t v = 0; v < x.size(); ++v) position(static_cast<Eigen::Index>(v), 0) = x[v];
    return position;
}

TEST(PositionProjection, BringsOneEdgeToItsLimitInOneSweep) {
    const PositionProjection projection = chain(2, Eigen::Vector2d(1.0, 3.0));
    Positions position = line({0.0, 3.0});
    EXPECT_DOUBLE_EQ(projection.overstretch(position), 2.0);
    projection.sweep(position, 1);
    // w = 1 and 1/3: the first end takes three quarters of the overlength 2
    EXPECT_NEAR(position(0, 0), 1.5, 1e-15);
    EXPECT_NEAR(position(1, 0), 2.5, 1e-15);
    EXPECT_NEAR(projection.overstretch(position), 0.0, 1e-15);
    const Positions once = position;
    projection.sweep(position, 5);
    EXPECT_LT((position - once).cwiseAbs().maxCoeff(), 1e-15) << "there is nothing left to do";
}

TEST(PositionProjection, LeavesShortEdgesAlone) {
    const PositionProjection projection = chain(3, Eigen::Vector3d::Ones());
    Positions position = line({0.0, 0.5, 0.5});  // one edge shorter, one without length
    const Positions start = position;
    projection.sweep(position, 10);
    EXPECT_EQ(position, start);
    EXPECT_EQ(projection.overstretch(position), 0.0);
}

TEST(PositionProjection, IsGaussSeidelInTheEdgesOrder) {
    const PositionProjection projection = chain(3, Eigen::Vector3d::Ones());
    Positions position = line({0.0, 2.0, 4.0});
    projection.sweep(position, 1);
    // The first edge takes (0, 2) to (0.5, 1.5); the second sees (1.5, 4) and takes it to (2.25, 3.25).
    EXPECT_NEAR(position(0, 0), 0.5, 1e-15);
    EXPECT_NEAR(position(1, 0), 2.25, 1e-15);
    EXPECT_NEAR(position(2, 0), 3.25, 1e-15);
}

TEST(PositionProjection, KeepsTheWeightedCentreAndConverges) {
    Eigen::VectorXd stiffness(6);
    stiffness << 1, 2, 1, 4, 1, 0.5;
    const PositionProjection projection = chain(6, stiffness);
    Positions position = line({0.0, 1.5, 3.0, 4.5, 6.0, 7.5});
    position(2, 1) = 0.7;
    const Eigen::RowVector3d centre = stiffness.transpose() * position;
    const double start = projection.overstretch(position);
    projection.sweep(position, 3);
    EXPECT_LT(projection.overstretch(position), start);
    EXPECT_GT(projection.overstretch(position), 1e-6) << "a few sweeps are not enough";
    projection.sweep(position, 300);
    EXPECT_LT(projection.overstretch(position), 1e-12);
    EXPECT_LT((stiffness.transpose() * position - centre).norm(), 1e-13);
}

TEST(PositionProjection, RefusesWhatDoesNotFit) {
    const Edges edge = Edges::Constant(1, 2, 1);
    EXPECT_THROW(PositionProjection(edge, Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(2)), Error);
    EXPECT_THROW(PositionProjection(edge, Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1)), Error);
    const PositionProjection projection = chain(3, Eigen::Vector3d::Ones());
    Positions position = line({0.0, 1.0});
    EXPECT_THROW(projection.sweep(position, 1), Error);
}

}  // namespace
}  // namespace toile::evaluate
