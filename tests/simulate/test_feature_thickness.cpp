#include <gtest/gtest.h>

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

TEST(FeatureThickness, VerticesAndEdgesGoByTheirThinnestTriangle) {
    ClothMesh mesh = test::cloth_square(2, 0.1, 0.0);
    mesh.pattern_position(0, 0) += 0.0495;  // next to its neighbour: one thin triangle
    const FeatureThickness found = of_square(mesh, 0.002);
    int thin = 0;
    const double least = found.triangle.minCoeff(&thin);
    EXPECT_LT(least, 0.002);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(found.vertex[mesh.triangle(thin, c)], least);
    EXPECT_EQ(found.vertex[8], 0.002) << "the far corner";
    EXPECT_EQ((found.edge.array() == least).count(), 3);
}

}  // namespace
}  // namespace toile::simulate
