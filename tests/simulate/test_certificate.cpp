#include <gtest/gtest.h>

#include "simulate/certificate.h"
#include "skin/surface_extraction.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

TEST(Certificate, EveryStatusHasItsOwnReason) {
    const auto reasons = status_reasons();
    ASSERT_EQ(reasons.size(), static_cast<size_t>(drape_status_count));
    for (size_t i = 0; i < reasons.size(); ++i)
        for (size_t j = 0; j < i; ++j) EXPECT_NE(reasons[i], reasons[j]);
    EXPECT_EQ(reasons[0], "accepted");
    EXPECT_EQ(reasons[7], "crashed");
    EXPECT_EQ(reasons[8], "out_of_memory");
    for (int status = 0; status < drape_status_count; ++status)
        EXPECT_EQ(process_failed(static_cast<DrapeStatus>(status)), status >= 7);
}

TEST(Certificate, RestLengthIsTheMeanOverPanels) {
    // One edge between two panels that were cut with different lengths there.
    ClothMesh mesh;
    mesh.triangle.resize(2, 3);
    mesh.triangle << 0, 1, 2, 1, 0, 3;
    mesh.pattern_position.resize(6, 2);
    mesh.pattern_position << 0, 0, 1.0, 0, 0.5, 1, 5, 0, 6.2, 0, 5.5, -1;
    mesh.pattern_triangle.resize(2, 3);
    mesh.pattern_triangle << 0, 1, 2, 4, 3, 5;
    mesh.rest_position = Positions::Random(4, 3);
    const Topology topology = build_topology(mesh.triangle);
    EXPECT_NEAR(edge_rest_lengths(mesh, topology)[0], 1.1, 1e-12);
}

TEST(Certificate, StretchRangeFindsTheExtremes) {
    const ClothMesh mesh = test::cloth_square(3, 0.3, 0.0);
    const Topology topology = build_topology(mesh.triangle);
    Positions x = mesh.rest_position;
    x.col(0) *= 1.2;
    x.col(2) *= 0.9;
    const StretchRange range = stretch_range(topology, edge_rest_lengths(mesh, topology), x);
    EXPECT_NEAR(range.largest, 1.2, 1e-12);
    EXPECT_NEAR(range.smallest, 0.9, 1e-12);
}

TEST(Certificate, PenetrationIsTheDeepestVertexBelowTheMesh) {
    const auto ball = skin::extract_surface([](const Eigen::Vector3d& p) { return p.norm() - 0.1; },
                                            Eigen::Vector3d::Constant(-0.15), Eigen::Vector3d::Constant(0.15), 0.01);
    Positions cloth(3, 3);
    cloth << 0.2, 0, 0, 0, 0.11, 0, 0, 0, -0.13;
    const Eigen::VectorXd far = Eigen::VectorXd::Constant(3, 0.02);
    EXPECT_EQ(body_penetration(ball.triangle, ball.position, cloth, far), 0.0);
    cloth.row(1) << 0.0, 0.093, 0.0;
    EXPECT_NEAR(body_penetration(ball.triangle, ball.position, cloth, far), 0.007, 1e-3);
}

TEST(Certificate, AVertexBetweenTwoOverlappingLimbsIsInside) {
    // Two balls that overlap: a point in one, near the buried surface of the other, on its outer side.
    const auto ball = skin::extract_surface([](const Eigen::Vector3d& p) { return p.norm() - 0.1; },
                                            Eigen::Vector3d::Constant(-0.15), Eigen::Vector3d::Constant(0.15), 0.01);
    const int n = static_cast<int>(ball.position.rows());
    Positions position(2 * n, 3);
    position << ball.position, ball.position.rowwise() + Eigen::RowVector3d(0.12, 0, 0);
    Triangles triangle(2 * ball.triangle.rows(), 3);
    triangle << ball.triangle, ball.triangle.array() + n;
    Positions cloth(1, 3);
    // 3 mm outside of the second ball's buried surface and 8 cm deep in the first: only the level set of both suspects
    // it.
    cloth << 0.017, 0.0, 0.0;
    EXPECT_NEAR(body_penetration(triangle, position, cloth, Eigen::VectorXd::Constant(1, -0.02)), 0.02, 1e-12);
    // What the level set suspects wrongly is outside all the same.
    cloth << 0.0, 0.12, 0.0;
    EXPECT_EQ(body_penetration(triangle, position, cloth, Eigen::VectorXd::Constant(1, -0.02)), 0.0);
}

}  // namespace
}  // namespace toile::simulate
