#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "cloth/topology.h"
#include "skin/surface_relaxation.h"

namespace toile::skin {
namespace {

double smallest_angle(const Surface& surface) {
    double smallest = M_PI;
    for (Eigen::Index f = 0; f < surface.triangle.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const Eigen::Vector3d p = surface.position.row(surface.triangle(f, c));
            const Eigen::Vector3d u = surface.position.row(surface.triangle(f, (c + 1) % 3)).transpose() - p;
            const Eigen::Vector3d v = surface.position.row(surface.triangle(f, (c + 2) % 3)).transpose() - p;
            smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
        }
    return smallest;
}

TEST(RelaxSurface, RoundsTrianglesAndKeepsSurfaceAndTopology) {
    const Eigen::Vector3d center(0.013, 0.5, -0.004);
    const auto capsule = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector3d axis(0.0, std::clamp(p.y() - center.y(), -0.1, 0.1), 0.0);
        return (p - center - axis).norm() - 0.05;
    };
    const Eigen::Vector3d half(0.08, 0.18, 0.08);
    const Surface extracted = extract_surface(capsule, center - half, center + half, 0.011);
    Surface relaxed = extracted;
    relax_surface(capsule, 8, relaxed);
    EXPECT_LT(smallest_angle(extracted), 0.30) << "there must be something to mend";
    EXPECT_GT(smallest_angle(relaxed), 0.45);
    ASSERT_EQ(relaxed.position.rows(), extracted.position.rows());
    ASSERT_EQ(relaxed.triangle.rows(), extracted.triangle.rows());
    for (Eigen::Index v = 0; v < relaxed.position.rows(); ++v) EXPECT_NEAR(capsule(relaxed.position.row(v)), 0.0, 5e-5);
    const Topology topology = build_topology(relaxed.triangle);
    EXPECT_EQ(topology.non_manifold_edge, -1);
    EXPECT_EQ((topology.edge_triangle.array() < 0).count(), 0);
    EXPECT_EQ(relaxed.position.rows() - topology.edge.rows() + relaxed.triangle.rows(), 2);
}

}  // namespace
}  // namespace toile::skin
