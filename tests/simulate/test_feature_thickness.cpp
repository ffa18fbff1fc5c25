#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "simulate/certificate.h"
#include "simulate/feature_thickness.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

FeatureThickness of_square(const ClothMesh& mesh, double thickness) {
    const Topology topology = build_topology(mesh.triangle);
    return feature_thickness(mesh, topology, edge_rest_lengths(mesh, topology), thickness);
}

TEST(FeatureThickness, IsTheWantedOneOnLargeTriangles) {
    const FeatureThickness found = of_square(test::cloth_square(4, 0.1, 0.0), 0.002);
    for (const Eigen::VectorXd& all : {found.vertex, found.triangle, found.edge}) {
        EXPECT_EQ(all.minCoeff(), 0.002);
        EXPECT_EQ(all.maxCoeff(), 0.002);
    }
}

TEST(FeatureThickness, IsHalfTheHeightOfSmallOnes) {
    const FeatureThickness found = of_square(test::cloth_square(10, 0.01, 0.0), 0.002);
    const double height = 0.001 / std::sqrt(2.0);  // over the diagonal
    for (const Eigen::VectorXd& all : {found.vertex, found.triangle, found.edge}) {
        EXPECT_NEAR(all.minCoeff(), 0.5 * height, 1e-12);
        EXPECT_NEAR(all.maxCoeff(), 0.5 * height, 1e-12);
    }
}

TEST(FeatureThickness, AllThatMeetsASliverIsAsThin) {
    ClothMesh mesh = test::cloth_square(4, 0.2, 0.0);
    mesh.pattern_position(0, 0) += 0.0495;  // a corner, next to its neighbour: one thin triangle
    const Topology topology = build_topology(mesh.triangle);
    const FeatureThickness found = feature_thickness(mesh, topology, edge_rest_lengths(mesh, topology), 0.002);
    const double least = found.vertex.minCoeff();
    EXPECT_LT(least, 0.002);
    const std::array<int, 3> sliver{0, 1, 5};
    for (int v = 0; v < mesh.vertex_count(); ++v)
        EXPECT_EQ(found.vertex[v], std::count(sliver.begin(), sliver.end(), v) ? least : 0.002) << v;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        bool meets = false;
        for (int c = 0; c < 3; ++c) meets |= found.vertex[mesh.triangle(f, c)] == least;
        EXPECT_EQ(found.triangle[f], meets ? least : 0.002) << f;
    }
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const bool meets = found.vertex[topology.edge(e, 0)] == least || found.vertex[topology.edge(e, 1)] == least;
        EXPECT_EQ(found.edge[e], meets ? least : 0.002) << e;
    }
}

}  // namespace
}  // namespace toile::simulate
