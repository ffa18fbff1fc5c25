#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "cloth/error.h"
#include "pattern/pattern_layout.h"
#include "tests/pattern/two_panels.h"

namespace toile::pattern {
namespace {

TEST(PatternLayout, ChartsFollowThePanelsOrder) {
    TwoPanels cloth = two_panels(4);
    EXPECT_EQ(pattern_charts(cloth.mesh, cloth.triangle_panel), cloth.triangle_panel);
    std::vector<int> swapped = cloth.triangle_panel;
    for (int& panel : swapped) panel = 1 - panel;
    EXPECT_EQ(pattern_charts(cloth.mesh, swapped), swapped);
}

TEST(PatternLayout, APanelInTwoPartsMakesTwoCharts) {
    const TwoPanels cloth = two_panels(4);
    const std::vector<int> one_panel(cloth.triangle_panel.size(), 0);
    EXPECT_EQ(pattern_charts(cloth.mesh, one_panel), cloth.triangle_panel);
    EXPECT_EQ(pattern_charts(cloth.mesh, {}), cloth.triangle_panel);
}

/// Distances in pixels are those of the pattern, in both directions.
void expect_uniform_scale(const ClothMesh& mesh, const PatternLayout& layout) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const int a = mesh.pattern_triangle(f, 0), b = mesh.pattern_triangle(f, 1);
        const Eigen::Vector3d pixel = layout.pattern_pixel.row(b) - layout.pattern_pixel.row(a);
        const Eigen::Vector2d flat = mesh.pattern_position.row(b) - mesh.pattern_position.row(a);
        EXPECT_EQ(pixel.x(), 0.0);
        EXPECT_NEAR(pixel.y() * layout.pixel, flat.x(), 1e-12);
        EXPECT_NEAR(pixel.z() * layout.pixel, -flat.y(), 1e-12);
    }
}

TEST(PatternLayout, LayersUseTheWholeImageAtOneScale) {
    const TwoPanels cloth = two_panels(4);
    const PatternLayout layout = lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::layers, 64);
    EXPECT_EQ(layout.layers, 2);
    expect_uniform_scale(cloth.mesh, layout);
    EXPECT_DOUBLE_EQ(layout.pixel, 0.2 / (63 - 2 * chart_margin));
    EXPECT_DOUBLE_EQ(layout.pattern_pixel.col(1).minCoeff(), chart_margin);
    EXPECT_NEAR(layout.pattern_pixel.col(1).maxCoeff(), 63 - chart_margin, 1e-9);
    EXPECT_DOUBLE_EQ(layout.pattern_pixel.col(2).maxCoeff(), 63 - chart_margin);
}

TEST(PatternLayout, AtlasKeepsChartsApartAndInside) {
    const TwoPanels cloth = two_panels(4);
    const PatternLayout layout = lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::atlas, 64);
    EXPECT_EQ(layout.layers, 1);
    expect_uniform_scale(cloth.mesh, layout);
    EXPECT_GE(layout.pattern_pixel.rightCols<2>().minCoeff(), chart_margin - 1e-9);
    EXPECT_LE(layout.pattern_pixel.rightCols<2>().maxCoeff(), 63 - chart_margin + 1e-9);
    const Eigen::Index half = layout.pattern_pixel.rows() / 2;
    double nearest = 1e9;
    for (Eigen::Index i = 0; i < half; ++i)
        for (Eigen::Index j = half; j < 2 * half; ++j)
            nearest =
                std::min(nearest, (layout.pattern_pixel.row(i) - layout.pattern_pixel.row(j)).cwiseAbs().maxCoeff());
    EXPECT_GE(nearest, 3.0);
    // Two squares side by side take half of a square's width each.
    EXPECT_LT(layout.pixel, 0.2 / (63 - 2 * chart_margin) * 2.4);
}

TEST(PatternLayout, SaysWhereAPatternDoesNotFit) {
    const TwoPanels cloth = two_panels(1);
    EXPECT_THROW(lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::layers, 7), Error);
    EXPECT_NO_THROW(lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::layers, 8));
    EXPECT_THROW(lay_out(cloth.mesh, cloth.triangle_panel, ImageLayout::atlas, 8), Error);
}

}  // namespace
}  // namespace toile::pattern
