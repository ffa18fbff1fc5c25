#include <gtest/gtest.h>

#include <algorithm>

#include "generate/rendering.h"

namespace toile::generate {
namespace {

/// A square of side 0.2 m about the origin, at a depth.
RenderedSurface square(double z, const Color& color) {
    RenderedSurface surface;
    surface.position.resize(4, 3);
    surface.position << -0.1, -0.1, z, 0.1, -0.1, z, 0.1, 0.1, z, -0.1, 0.1, z;
    surface.triangle.resize(2, 3);
    surface.triangle << 0, 1, 2, 0, 2, 3;
    surface.color.assign(4, color);
    return surface;
}

const std::uint8_t* pixel(const files::Picture& picture, int x, int y) {
    return &picture.value[3 * (static_cast<size_t>(y) * picture.width + x)];
}

TEST(Rendering, TheNearerSurfaceIsSeenInItsPlace) {
    FrontView view;
    view.width = view.height = 100;
    view.metres_per_pixel = 0.004;
    RenderedSurface near = square(0.5, {1, 0, 0});
    near.position.col(0).array() += 0.1;
    for (const auto& surface : {std::vector{near, square(0, {0, 0, 1})}, std::vector{square(0, {0, 0, 1}), near}}) {
        const files::Picture picture = render(surface, view);
        EXPECT_GT(pixel(picture, 60, 50)[0], 100);  // the near one is red
        EXPECT_EQ(pixel(picture, 60, 50)[2], 0);
        EXPECT_EQ(pixel(picture, 40, 50)[0], 0);  // the far one is blue
        EXPECT_GT(pixel(picture, 40, 50)[2], 100);
        EXPECT_EQ(pixel(picture, 10, 50)[1], 255);  // and the ground white
        EXPECT_EQ(pixel(picture, 40, 10)[1], 255);
    }
}

TEST(Rendering, UpIsUpAndBothSidesAreSeen) {
    FrontView view;
    view.width = view.height = 100;
    view.metres_per_pixel = 0.004;
    RenderedSurface high = square(0, {0, 0, 0});
    high.position.col(1).array() += 0.1;
    high.triangle.col(1).swap(high.triangle.col(2));
    const files::Picture picture = render({high}, view);
    EXPECT_EQ(pixel(picture, 50, 20)[0], 0);
    EXPECT_EQ(pixel(picture, 50, 80)[0], 255);
}

TEST(Rendering, WhatLiesOutsideOrEdgeOnIsLeftOut) {
    FrontView view;
    view.width = view.height = 20;
    view.metres_per_pixel = 0.004;
    RenderedSurface edge_on = square(0, {0, 0, 0}), away = square(0, {0, 0, 0});
    edge_on.position.col(1).setZero();
    away.position.col(0).array() += 100;
    const files::Picture picture = render({edge_on, away}, view);
    EXPECT_EQ(std::count(picture.value.begin(), picture.value.end(), 255), 3 * 20 * 20);
}

}  // namespace
}  // namespace toile::generate
