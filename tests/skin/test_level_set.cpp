#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

#include "cloth/error.h"
#include "skin/level_set.h"
#include "skin/surface_query.h"
#include "tests/support/derivative_checker.h"

namespace toile::skin {
namespace {

/// A sphere of latitude rings, poles at +-y.
Surface make_sphere(const Eigen::Vector3d& center, double radius, int rings) {
    const int segments = 2 * rings;
    Surface sphere;
    sphere.position.resize((rings - 1) * segments + 2, 3);
    sphere.triangle.resize(2 * segments * (rings - 1), 3);
    const int south = (rings - 1) * segments, north = south + 1;
    const auto at = [&](int ring, int segment) { return (ring - 1) * segments + segment % segments; };
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < segments; ++j) {
            const double latitude = std::numbers::pi * i / rings, longitude = 2.0 * std::numbers::pi * j / segments;
            sphere.position.row(at(i, j)) =
                center + radius * Eigen::Vector3d(std::sin(latitude) * std::sin(longitude), -std::cos(latitude),
                                                  std::sin(latitude) * std::cos(longitude));
        }
    sphere.position.row(south) = center - Eigen::Vector3d(0, radius, 0);
    sphere.position.row(north) = center + Eigen::Vector3d(0, radius, 0);
    int f = 0;
    for (int j = 0; j < segments; ++j) {
        sphere.triangle.row(f++) << south, at(1, j + 1), at(1, j);
        for (int i = 1; i + 1 < rings; ++i) {
            sphere.triangle.row(f++) << at(i, j), at(i, j + 1), at(i + 1, j + 1);
            sphere.triangle.row(f++) << at(i, j), at(i + 1, j + 1), at(i + 1, j);
        }
        sphere.triangle.row(f++) << north, at(rings - 1, j), at(rings - 1, j + 1);
    }
    return sphere;
}

class LevelSetOfSphere : public testing::Test {
  protected:
    const Eigen::Vector3d center{0.013, 0.971, -0.027};
    const double radius = 0.1, voxel = 0.005, band_width = 0.02;
    Surface sphere = make_sphere(center, radius, 64);
    LevelSet level_set{sphere.triangle, sphere.position, voxel, band_width};
    std::mt19937 random{7};

    Eigen::Vector3d direction() {
        std::normal_distribution<double> normal;
        Eigen::Vector3d d;
        for (double& c : d) c = normal(random);
        return d.normalized();
    }
};

TEST_F(LevelSetOfSphere, MatchesTheAnalyticDistanceAndGradientInTheBand) {
    const LevelSet::Sampler sampler(level_set);
    for (int i = 0; i < 4000; ++i) {
        const double offset = (i % 29 - 14) * 0.001;
        const Eigen::Vector3d d = direction();
        const LevelSet::Sample sample = sampler(center + (radius + offset) * d);
        // Facets, linear interpolation (voxel^2 / 4r = 0.06 mm) and renormalisation, which grows beyond two voxels.
        const bool near_surface = std::abs(offset) < 0.009;
        EXPECT_NEAR(sample.distance, offset, near_surface ? 2e-4 : 1.5e-3);
        EXPECT_LT((sample.gradient - d).norm(), near_surface ? 0.08 : 0.3);
    }
}

TEST_F(LevelSetOfSphere, DistanceAloneIsTheSampledDistance) {
    const LevelSet::Sampler sampler(level_set);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d point = center + 0.0002 * i * direction();
        EXPECT_EQ(sampler(point).distance, sampler.distance(point));
    }
}

TEST_F(LevelSetOfSphere, GradientIsTheDerivativeOfTheInterpolant) {
    const LevelSet::Sampler sampler(level_set);
    const double step = 1e-6;
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d point = center + (radius + (i % 31 - 15) * 0.001) * direction();
        const Eigen::Vector3d fraction = (point / voxel).array() - (point / voxel).array().floor();
        if (fraction.minCoeff() < 1e-3 || fraction.maxCoeff() > 1.0 - 1e-3)
            continue;  // the interpolant has kinks there
        Eigen::Vector3d difference;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
            difference[axis] = (sampler.distance(point + shift) - sampler.distance(point - shift)) / (2.0 * step);
        }
        EXPECT_LT((sampler(point).gradient - difference).norm(), 1e-8);
        EXPECT_GT(difference.norm(), 0.5);
        ++compared;
    }
    EXPECT_GT(compared, 1500);
}

TEST_F(LevelSetOfSphere, NamesANearestTriangle) {
    const LevelSet::Sampler sampler(level_set);
    const SurfaceQuery query(sphere.triangle, sphere.position);
    for (int i = 0; i < 500; ++i) {
        const Eigen::Vector3d point = center + (radius + (i % 29 - 14) * 0.001) * direction();
        const int triangle = sampler(point).triangle;
        ASSERT_GE(triangle, 0);
        const Eigen::Vector3d named = sphere.position.row(sphere.triangle(triangle, 0));
        EXPECT_LT((named - query.nearest(point).position).norm(),
                  2.5 * voxel);  // its own size and half a voxel diagonal
    }
}

TEST_F(LevelSetOfSphere, IsClampedWithoutGradientOutsideTheBand) {
    const LevelSet::Sampler sampler(level_set);
    const auto expect_clamped = [&](const Eigen::Vector3d& point, double distance) {
        const LevelSet::Sample sample = sampler(point);
        EXPECT_EQ(sample.distance, distance);
        EXPECT_EQ(sample.gradient.norm(), 0.0);
        EXPECT_EQ(sample.triangle, -1);
        EXPECT_EQ(sampler.distance(point), distance);
    };
    expect_clamped(center, -band_width);
    expect_clamped(center + Eigen::Vector3d(0.06, 0, 0), -band_width);
    expect_clamped(center + Eigen::Vector3d(0.135, 0, 0), band_width);
    expect_clamped(center + Eigen::Vector3d(50.0, 0, 0), band_width);
    expect_clamped(Eigen::Vector3d(1e30, 0, 0), band_width);
    expect_clamped(Eigen::Vector3d(0, std::numeric_limits<double>::quiet_NaN(), 0), band_width);
}

TEST_F(LevelSetOfSphere, NeverExceedsAWideBand) {
    const double wide = 0.05;
    const LevelSet wide_set(sphere.triangle, sphere.position, 2.0 * voxel, wide);
    const LevelSet::Sampler sampler(wide_set);
    for (int i = 0; i < 2000; ++i) {
        const double r = 0.0001 * i;
        const double expected = std::clamp(r - radius, -wide, wide);
        EXPECT_NEAR(sampler.distance(center + r * direction()), expected, 3e-3);
        EXPECT_LE(std::abs(sampler.distance(center + r * direction())), wide);
    }
}

TEST(LevelSet, HoldsTheTrianglesDistancesAtTheVoxels) {
    const Surface sphere = make_sphere({0.004, 0.5, 0.003}, 0.1, 24);
    const double voxel = 0.004;
    const LevelSet level_set(sphere.triangle, sphere.position, voxel, 3.0 * voxel);
    const LevelSet::Sampler sampler(level_set);
    const SurfaceQuery query(sphere.triangle, sphere.position);
    double worst = 0.0, worst_beyond = 0.0;
    for (int i = -30; i <= 30; i += 3)
        for (int j = 95; j <= 155; j += 3)
            for (int k = -30; k <= 30; k += 3) {
                const Eigen::Vector3d voxel_center = Eigen::Vector3d(i, j, k) * voxel;
                const double expected = query.nearest(voxel_center).signed_distance;
                if (std::abs(expected) > 3.0 * voxel) continue;
                double& bound = std::abs(expected) < 2.0 * voxel ? worst : worst_beyond;
                bound = std::max(bound, std::abs(sampler.distance(voxel_center) - expected));
            }
    EXPECT_LT(worst, voxel / 20.0);
    EXPECT_LT(worst_beyond, voxel / 3.0);
}

TEST(LevelSet, OverlappingSurfacesGiveTheUnionOfTheirInsides) {
    const Eigen::Vector3d left(-0.04, 0, 0), right(0.05, 0.01, 0);
    const double radius = 0.08, voxel = 0.004, band_width = 0.012;
    Surface both = make_sphere(left, radius, 40);
    const Surface other = make_sphere(right, radius, 40);
    const Eigen::Index v = both.position.rows(), f = both.triangle.rows();
    both.position.conservativeResize(v + other.position.rows(), 3);
    both.position.bottomRows(other.position.rows()) = other.position;
    both.triangle.conservativeResize(f + other.triangle.rows(), 3);
    both.triangle.bottomRows(other.triangle.rows()) = other.triangle.array() + static_cast<int>(v);
    const LevelSet level_set(both.triangle, both.position, voxel, band_width);
    const LevelSet::Sampler sampler(level_set);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.15, 0.15);
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
        const double expected = std::min((point - left).norm(), (point - right).norm()) - radius;
        if (std::abs(expected) < 0.25 * voxel) continue;
        const double sampled = sampler.distance(point);
        EXPECT_EQ(sampled < 0.0, expected < 0.0) << point.transpose() << " expected " << expected;
        if (expected > voxel && expected < band_width - 2.0 * voxel) {
            EXPECT_NEAR(sampled, expected, 2e-3);
        }
    }
}

TEST(LevelSet, KeepsTheGapBetweenTwoPartsOpen) {
    constexpr double radius = 0.1, voxel = 0.006, gap = 0.004;
    const Surface one = make_sphere({-radius - 0.5 * gap, 0, 0}, radius, 48);
    const Surface other = make_sphere({radius + 0.5 * gap, 0, 0}, radius, 48);
    Surface both;
    const int vertices = static_cast<int>(one.position.rows()), triangles = static_cast<int>(one.triangle.rows());
    both.position.resize(2 * vertices, 3);
    both.position << one.position, other.position;
    both.triangle.resize(2 * triangles, 3);
    both.triangle << one.triangle, (other.triangle.array() + vertices).matrix();
    const LevelSet joined(both.triangle, {triangles, 2 * triangles}, both.position, voxel, 0.02);
    const LevelSet::Sampler sample(joined);
    for (const double y : {0.0, 0.01, 0.02, 0.03}) {
        const double analytic = std::hypot(radius + 0.5 * gap, y) - radius;
        // The crease in the middle of the gap is smoothed over a voxel.
        EXPECT_NEAR(sample.distance({0.0, y, 0.0}), analytic, 0.3 * voxel) << y;
        EXPECT_GT(sample.distance({0.0, y, 0.0}), 0.0) << y;
    }
    for (const double side : {-1.0, 1.0}) {
        EXPECT_EQ(sample({side * 0.012, 0.0, 0.0}).triangle >= triangles, side > 0.0);
        EXPECT_NEAR(sample.distance({side * 0.012, 0.0, 0.0}), 0.5 * gap - 0.012, 0.1 * voxel);
    }
}

TEST(LevelSet, GivesTheSameBytesFromTwoThreadsAtOnce) {
    const Surface sphere = make_sphere({0.1, 0.2, 0.3}, 0.12, 30);
    const auto sample_all = [&] {
        const LevelSet level_set(sphere.triangle, sphere.position, 0.006, 0.018);
        const LevelSet::Sampler sampler(level_set);
        std::mt19937 random(11);
        std::uniform_real_distribution<double> uniform(-0.15, 0.15);
        std::vector<double> samples;
        for (int i = 0; i < 20000; ++i) {
            const Eigen::Vector3d offset(uniform(random), uniform(random), uniform(random));
            const LevelSet::Sample sample = sampler(Eigen::Vector3d(0.1, 0.2, 0.3) + offset);
            samples.insert(samples.end(), {sample.distance, sample.gradient[0], sample.gradient[1], sample.gradient[2],
                                           static_cast<double>(sample.triangle)});
        }
        return samples;
    };
    std::vector<std::vector<double>> result(3);
    result[0] = sample_all();
    std::thread first([&] { result[1] = sample_all(); }), second([&] { result[2] = sample_all(); });
    first.join();
    second.join();
    for (int i = 1; i < 3; ++i)
        EXPECT_EQ(std::memcmp(result[0].data(), result[i].data(), result[0].size() * sizeof(double)), 0);
}

TEST(LevelSet, RefusesWhatItCannotConvert) {
    const Surface sphere = make_sphere({0, 0, 0}, 0.1, 8);
    EXPECT_NO_THROW(LevelSet(sphere.triangle, sphere.position, 0.01, 0.03));
    EXPECT_THROW(LevelSet(sphere.triangle, sphere.position, 0.0, 0.03), Error);
    EXPECT_THROW(LevelSet(sphere.triangle, sphere.position, std::nan(""), 0.03), Error);
    EXPECT_THROW(LevelSet(sphere.triangle, sphere.position, 0.01, 0.015), Error);
    EXPECT_THROW(LevelSet(Triangles(0, 3), sphere.position, 0.01, 0.03), Error);
    Surface broken = sphere;
    broken.position(3, 1) = std::nan("");
    EXPECT_THROW(LevelSet(broken.triangle, broken.position, 0.01, 0.03), Error);
    broken = sphere;
    broken.triangle(2, 0) = static_cast<int>(sphere.position.rows());
    EXPECT_THROW(LevelSet(broken.triangle, broken.position, 0.01, 0.03), Error);
    broken = sphere;
    broken.position(0, 0) = 1e9;
    EXPECT_THROW(LevelSet(broken.triangle, broken.position, 0.01, 0.03), Error);
}

TEST(LevelSet, SmoothCurvatureIsTheGradientsDerivative) {
    const Surface ball = make_sphere(Eigen::Vector3d::Zero(), 0.1, 40);
    const LevelSet level_set(ball.triangle, ball.position, 0.01, 0.04);
    const LevelSet::Sampler sampler(level_set);
    // Within voxels, away from their sides, where the curvature jumps.
    for (const Eigen::Vector3d& cell :
         {Eigen::Vector3d(9, 2, 1), Eigen::Vector3d(-3, 8, -5), Eigen::Vector3d(1, -10, 2)}) {
        const Eigen::Vector3d point = 0.01 * (cell + Eigen::Vector3d(0.13, -0.21, 0.09));
        const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd { return sampler.smooth(at).gradient; };
        const Eigen::Matrix3d curvature = sampler.smooth_curvature(point);
        EXPECT_GT(curvature.norm(), 5.0);
        const auto check = test::check_jacobian(gradient, curvature, point, 1e-3, 1e-6);
        EXPECT_TRUE(check.passed) << check.message;
    }
    EXPECT_EQ(sampler.smooth_curvature({1.0, 1.0, 1.0}).norm(), 0.0) << "far away";
}

}  // namespace
}  // namespace toile::skin
