#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pattern/rasterizer.h"
#include "tests/pattern/two_panels.h"

namespace toile::pattern {
namespace {

TEST(Rasterizer, WeightsOfAPixelSumToOneAndStayBounded) {
    const TwoPanels cloth = two_panels(6);
    for (const ImageLayout style : {ImageLayout::layers, ImageLayout::atlas}) {
        const PatternLayout layout = lay_out(cloth.mesh, cloth.triangle_panel, style, 40);
        const Raster raster = rasterize(cloth.mesh, layout);
        int filled = 0;
        for (Eigen::Index i = 0; i < raster.vertex_to_pixel.rows(); ++i) {
            double sum = 0, largest = 0;
            for (PixelWeights::InnerIterator entry(raster.vertex_to_pixel, i); entry; ++entry) {
                sum += entry.value();
                largest = std::max(largest, std::abs(entry.value()));
            }
            if (largest == 0) continue;
            ++filled;
            EXPECT_NEAR(sum, 1.0, 1e-12);
            EXPECT_LT(largest, 3.0 + 1e-12);
            if (raster.mask[i]) {
                EXPECT_LE(largest, 1.0 + 1e-12);
            }
        }
        EXPECT_GT(filled, static_cast<int>(std::count(raster.mask.begin(), raster.mask.end(), 1)));
    }
}

TEST(Rasterizer, EveryPixelThatReadingTouchesIsFilled) {
    const TwoPanels cloth = two_panels(6);
    const PatternLayout layout = lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::atlas, 40);
    const Raster raster = rasterize(cloth.mesh, layout);
    const PixelWeights reading = reading_weights(cloth.mesh, layout);
    for (Eigen::Index v = 0; v < reading.rows(); ++v) {
        double sum = 0;
        for (PixelWeights::InnerIterator entry(reading, v); entry; ++entry) {
            sum += entry.value();
            if (entry.value() > 0) {
                EXPECT_TRUE(PixelWeights::InnerIterator(raster.vertex_to_pixel, entry.col())) << v;
            }
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
    }
}

TEST(Rasterizer, PixelsTakeTheCoveringTrianglesWeights) {
    // One triangle with corners on pixel centres: the weights are known by hand.
    ClothMesh mesh;
    mesh.triangle.resize(1, 3);
    mesh.triangle << 0, 1, 2;
    mesh.pattern_triangle = mesh.triangle;
    mesh.rest_position = Positions::Zero(3, 3);
    mesh.pattern_position = PlanePositions::Zero(3, 2);
    PatternLayout layout;
    layout.size = 12;
    layout.layers = 1;
    layout.pattern_pixel.resize(3, 3);
    layout.pattern_pixel << 0, 3, 8, 0, 7, 8, 0, 3, 4;  // layer, column, row
    const Raster raster = rasterize(mesh, layout);
    auto weight = [&](int column, int row, int vertex) {
        return raster.vertex_to_pixel.coeff(row * 12 + column, vertex);
    };
    EXPECT_NEAR(weight(3, 8, 0), 1.0, 1e-12);
    EXPECT_NEAR(weight(5, 8, 1), 0.5, 1e-12);
    EXPECT_NEAR(weight(4, 7, 0), 0.5, 1e-12);
    EXPECT_NEAR(weight(4, 7, 2), 0.25, 1e-12);
    EXPECT_EQ(std::count(raster.mask.begin(), raster.mask.end(), 1), 15);  // 5 + 4 + 3 + 2 + 1
    // One pixel beyond the left edge the linear field goes on.
    EXPECT_NEAR(weight(2, 8, 0), 1.25, 1e-12);
    EXPECT_NEAR(weight(2, 8, 1), -0.25, 1e-12);
    EXPECT_EQ(weight(0, 8, 0), 0.0);  // three pixels away
}

}  // namespace
}  // namespace toile::pattern
