#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "skin/surface_extraction.h"

namespace toile::skin {
namespace {

double volume(const Surface& surface) {
    double six_volumes = 0.0;
    for (Eigen::Index f = 0; f < surface.triangle.rows(); ++f) {
        const Eigen::Vector3d a = surface.position.row(surface.triangle(f, 0)),
                              b = surface.position.row(surface.triangle(f, 1)),
                              c = surface.position.row(surface.triangle(f, 2));
        six_volumes += a.dot(b.cross(c));
    }
    return six_volumes / 6.0;
}

class ExtractSurface : public testing::Test {
  protected:
    const Eigen::Vector3d center{0.03, 1.0, -0.02};
    const double radius = 0.2;
    const std::function<double(const Eigen::Vector3d&)> sphere = [this](const Eigen::Vector3d& p) {
        return (p - center).norm() - radius;
    };
    const Eigen::Vector3d lower = center.array() - 0.25, upper = center.array() + 0.25;
};

TEST_F(ExtractSurface, GivesAClosedManifoldWoundOutwards) {
    const Surface surface = extract_surface(sphere, lower, upper, 0.01);
    const Topology topology = build_topology(surface.triangle);
    EXPECT_EQ(topology.non_manifold_edge, -1);
    EXPECT_EQ((topology.edge_triangle.array() < 0).count(), 0);
    EXPECT_EQ(surface.position.rows() - topology.edge.rows() + surface.triangle.rows(), 2);
    EXPECT_NEAR(volume(surface), 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3), 1e-4);
    for (Eigen::Index v = 0; v < surface.position.rows(); ++v) EXPECT_NEAR(sphere(surface.position.row(v)), 0.0, 5e-4);
}

TEST_F(ExtractSurface, RefusesWhatItCannotExtract) {
    EXPECT_THROW(extract_surface(sphere, lower, upper, 0.0), Error);
    EXPECT_THROW(extract_surface(sphere, upper, lower, 0.01), Error);
    EXPECT_THROW(extract_surface(sphere, center, upper, 0.01), Error) << "the box cuts the sphere";
    EXPECT_THROW(extract_surface(sphere, lower, upper, 1e-6), Error);
    EXPECT_THROW(extract_surface([](const Eigen::Vector3d&) { return std::nan(""); }, lower, upper, 0.01), Error);
}

}  // namespace
}  // namespace toile::skin
