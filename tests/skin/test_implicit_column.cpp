#include <gtest/gtest.h>

#include <cmath>

#include "skin/implicit_column.h"

namespace toile::skin {
namespace {

const ColumnFrame upright{{0.1, 0.2, -0.3}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

TEST(ImplicitColumn, OfEqualSectionsIsACylinderWithItsDistance) {
    const ImplicitColumn cylinder(upright, {{0.0, 0.05, 0.05, 0.05}, {0.4, 0.05, 0.05, 0.05}}, {0.05, 0.05});
    const auto at = [&](double x, double y, double z) {
        return cylinder.distance(upright.origin + Eigen::Vector3d(x, y, z));
    };
    EXPECT_NEAR(at(0.08, 0.2, 0.0), 0.03, 1e-12);
    EXPECT_NEAR(at(0.0, 0.1, -0.02), -0.03, 1e-12);
    EXPECT_NEAR(at(0.0, 0.5, 0.0), 0.05, 1e-12) << "beyond the half sphere at its end";
    EXPECT_NEAR(at(0.03, -0.04, 0.0), 0.0, 1e-12) << "on the half sphere at its start";
    EXPECT_LT(at(0.0, 0.2, 0.0), -0.04) << "on the axis";
}

TEST(ImplicitColumn, VanishesOnItsSections) {
    const ImplicitColumn column(upright,
                                {{0.0, 0.05, 0.04, 0.03}, {0.1, 0.08, 0.06, 0.05, 0.01, 0.02}, {0.3, 0.06, 0.07, 0.02}},
                                {0.02, 0.03}, 2.5);
    const auto at = [&](double x, double y, double z) {
        // Side is front x along: -x here.
        return column.distance(upright.origin + Eigen::Vector3d(-x, y, z));
    };
    EXPECT_NEAR(at(0.09, 0.1, 0.02), 0.0, 1e-12) << "its side, shifted";
    EXPECT_NEAR(at(-0.07, 0.1, 0.02), 0.0, 1e-12) << "its other side, shifted";
    EXPECT_NEAR(at(0.01, 0.1, 0.08), 0.0, 1e-12) << "its front";
    EXPECT_NEAR(at(0.01, 0.1, -0.03), 0.0, 1e-12) << "its back";
    EXPECT_NEAR(at(0.0, 0.33, 0.0), 0.0, 1e-12) << "the tip of its end";
    EXPECT_NEAR(at(0.0, -0.02, 0.0), 0.0, 1e-12) << "the tip of its start";
}

TEST(ImplicitColumn, StaysBetweenNeighbouringSections) {
    const ImplicitColumn column(upright, {{0.0, 0.05, 0.05, 0.05}, {0.1, 0.05, 0.05, 0.05}, {0.2, 0.02, 0.02, 0.02}},
                                {0.02, 0.02});
    for (double y = 0.0; y <= 0.2; y += 0.005) {
        EXPECT_LE(column.distance(upright.origin + Eigen::Vector3d(0.02 - 1e-9, y, 0)), 0.0) << y;
        EXPECT_GE(column.distance(upright.origin + Eigen::Vector3d(0.05 + 1e-9, y, 0)), 0.0) << y;
    }
}

TEST(ImplicitColumn, BoundIsBelowTheDistanceOfItsSurface) {
    const ImplicitColumn column(
        upright, {{0.0, 0.05, 0.04, 0.03}, {0.1, 0.08, 0.06, 0.05, 0.01, 0.02}, {0.3, 0.06, 0.07, 0.02}}, {0.02, 0.03});
    for (double x = -0.2; x <= 0.2; x += 0.03)
        for (double y = -0.2; y <= 0.5; y += 0.03)
            for (double z = -0.2; z <= 0.2; z += 0.03) {
                const Eigen::Vector3d point = upright.origin + Eigen::Vector3d(x, y, z);
                if (column.distance(point) <= 0.0) {
                    EXPECT_LE(column.distance_bound(point), 0.0);
                }
            }
}

TEST(ImplicitColumn, MirrorsInTheMiddle) {
    const ImplicitColumn column({{0.1, 0.2, 0.3}, {1.0, -1.0, 0.2}, {0.0, 0.1, 1.0}},
                                {{0.0, 0.05, 0.04, 0.03, 0.01}, {0.3, 0.06, 0.07, 0.02}}, {0.02, 0.03});
    const ImplicitColumn mirror = column.mirrored();
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d point(0.01 * i, 0.2 - 0.006 * i, 0.3 + 0.05 * std::sin(i));
        EXPECT_DOUBLE_EQ(column.distance(point), mirror.distance({-point.x(), point.y(), point.z()}));
    }
}

TEST(SmoothUnion, RoundsTheSeamOnly) {
    EXPECT_DOUBLE_EQ(smooth_union(0.1, 0.2, 0.05), 0.1);
    EXPECT_DOUBLE_EQ(smooth_union(0.3, -0.2, 0.05), -0.2);
    EXPECT_DOUBLE_EQ(smooth_union(0.1, 0.1, 0.04), 0.09);
    EXPECT_DOUBLE_EQ(smooth_union(0.11, 0.1, 0.04), smooth_union(0.1, 0.11, 0.04));
}

}  // namespace
}  // namespace toile::skin
