#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulate/proximity.h"
#include "tests/simulate/random_points.h"

namespace toile::simulate {
namespace {

using Eigen::Vector3d;

FourPoints scaled(FourPoints x, double size, const Vector3d& place) {
    for (auto& p : x) p = size * p + place;
    return x;
}

double segment_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const double length = (b - a).squaredNorm();
    const double share = length > 0.0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
    return (p - a - share * (b - a)).norm();
}

// Least of a convex function of [0, 1], by golden sections.
template <typename Function>
double least(const Function& f) {
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = 0.0, high = 1.0, a = high - golden, b = low + golden, fa = f(a), fb = f(b);
    for (int i = 0; i < 80; ++i) {
        if (fa <= fb) {
            high = b, b = a, fb = fa;
            fa = f(a = high - golden * (high - low));
        } else {
            low = a, a = b, fa = fb;
            fb = f(b = low + golden * (high - low));
        }
    }
    return std::min({fa, fb, f(0.0), f(1.0)});
}

// From the vertex to the segments that cross the triangle from corner 1.
double triangle_distance_by_search(const FourPoints& x) {
    return least([&](double s) { return segment_distance(x[0], x[1], x[2] + s * (x[3] - x[2])); });
}
double edge_distance_by_search(const FourPoints& x) {
    return least([&](double s) { return segment_distance(x[0] + s * (x[1] - x[0]), x[2], x[3]); });
}

Vector3d combined(const Proximity& nearest, const FourPoints& x) {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < 4; ++i) sum += nearest.weight[i] * x[i];
    return sum;
}

// The weights are those of points inside the features, and belong to the difference and the distance.
void expect_consistent(const Proximity& nearest, const FourPoints& x, int first_count, double size, double place) {
    double first = 0.0, second = 0.0;
    for (int i = 0; i < 4; ++i) {
        EXPECT_GE((i < first_count ? 1.0 : -1.0) * nearest.weight[i], -1e-15);
        (i < first_count ? first : second) += nearest.weight[i];
    }
    EXPECT_NEAR(first, 1.0, 1e-15);
    EXPECT_NEAR(second, -1.0, 1e-15);
    EXPECT_LT((combined(nearest, x) - nearest.difference).norm(), 1e-14 * (size + place));
    EXPECT_DOUBLE_EQ(nearest.squared_distance, nearest.difference.squaredNorm());
}

TEST(Proximity, NearestPointsAreThoseOfASearch) {
    test::RandomPoints random(1);
    for (int i = 0; i < 1600; ++i) {
        const double size = i % 3 == 0 ? 1e-3 : 1.0;
        const FourPoints x = scaled(random.four(i % test::RandomPoints::kinds), size, Vector3d::Zero());
        const Proximity triangle = vertex_triangle_proximity(x), edge = edge_edge_proximity(x);
        SCOPED_TRACE(i);
        expect_consistent(triangle, x, 1, size, 0.0);
        expect_consistent(edge, x, 2, size, 0.0);
        // The search finds the place to half the digits, and so the distance to nearly all.
        EXPECT_NEAR(triangle.distance(), triangle_distance_by_search(x), 1e-8 * size);
        EXPECT_NEAR(edge.distance(), edge_distance_by_search(x), 1e-8 * size);
    }
}

TEST(Proximity, NoOtherPointIsNearer) {
    // The conditions of a minimum, to nearly all digits: moving along the feature in any direction leads away.
    test::RandomPoints random(2);
    for (int i = 0; i < 4000; ++i) {
        const FourPoints x = random.four(i % test::RandomPoints::kinds);
        SCOPED_TRACE(i);
        const Proximity triangle = vertex_triangle_proximity(x), edge = edge_edge_proximity(x);
        for (int j = 1; j < 4; ++j) {
            const Vector3d towards = triangle.difference - (x[0] - x[j]);
            EXPECT_LT(triangle.difference.dot(towards), 1e-8);
        }
        EXPECT_GT(vertex_triangle_separation(triangle.difference, x), triangle.squared_distance - 1e-8);
        EXPECT_GT(edge_edge_separation(edge.difference, x), edge.squared_distance - 1e-8);
    }
}

TEST(Proximity, FarFromTheOriginIsAsGood) {
    test::RandomPoints random(3);
    for (int i = 0; i < 800; ++i) {
        const FourPoints near = random.four(i % test::RandomPoints::kinds);
        const FourPoints far = scaled(near, 1.0, Vector3d(1000.0, -1000.0, 500.0));
        SCOPED_TRACE(i);
        EXPECT_NEAR(vertex_triangle_proximity(far).distance(), vertex_triangle_proximity(near).distance(), 1e-12);
        EXPECT_NEAR(edge_edge_proximity(far).distance(), edge_edge_proximity(near).distance(), 1e-12);
        expect_consistent(vertex_triangle_proximity(far), far, 1, 1.0, 1000.0);
        expect_consistent(edge_edge_proximity(far), far, 2, 1.0, 1000.0);
    }
}

TEST(Proximity, WeightsThatAreClampedAreZero) {
    const FourPoints corner = {Vector3d(-1, -1, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    EXPECT_EQ(vertex_triangle_proximity(corner).weight, (std::array<double, 4>{1.0, -1.0, 0.0, 0.0}));
    const FourPoints side = {Vector3d(0.25, -1, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    EXPECT_EQ(vertex_triangle_proximity(side).weight, (std::array<double, 4>{1.0, -0.75, -0.25, 0.0}));
    const FourPoints ends = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(2, 1, 0), Vector3d(3, 2, 0)};
    EXPECT_EQ(edge_edge_proximity(ends).weight, (std::array<double, 4>{0.0, 1.0, -1.0, 0.0}));
}

TEST(Proximity, DistancesGradientIsTheWeightsTimesTheDifference) {
    test::RandomPoints random(4);
    for (int i = 0; i < 100; ++i) {
        FourPoints x = random.four(0);
        const Proximity triangle = vertex_triangle_proximity(x), edge = edge_edge_proximity(x);
        const int vertex = random.whole(4), axis = random.whole(3);
        const double step = 1e-6;
        FourPoints up = x, down = x;
        up[vertex][axis] += step;
        down[vertex][axis] -= step;
        const auto slope = [&](auto proximity) {
            return (proximity(up).squared_distance - proximity(down).squared_distance) / (2.0 * step);
        };
        // Across an edge of a region the derivative is continuous, its own slope isn't: hence the step, not its square.
        EXPECT_NEAR(slope(vertex_triangle_proximity), 2.0 * triangle.weight[vertex] * triangle.difference[axis], 1e-4);
        EXPECT_NEAR(slope(edge_edge_proximity), 2.0 * edge.weight[vertex] * edge.difference[axis], 1e-4);
    }
}

TEST(Proximity, MollifierRisesFromParallelToOne) {
    FourPoints x = {Vector3d(0, 0, 0), Vector3d(2, 0, 0), Vector3d(0, 0, 1), Vector3d(3, 0, 1)};
    const double threshold = mollifier_threshold(2.0, 3.0);
    EXPECT_DOUBLE_EQ(threshold, 36e-3);
    EXPECT_EQ(parallel_mollifier(x, threshold).value, 0.0);
    x[3][1] = 0.5 * std::sqrt(threshold) / 2.0;  // a quarter of the threshold
    EXPECT_NEAR(parallel_mollifier(x, threshold).value, 0.25 * 1.75, 1e-14);
    x[3][1] = 1.0;
    EXPECT_EQ(parallel_mollifier(x, threshold).value, 1.0);
    EXPECT_EQ(parallel_mollifier(x, threshold).slope, 0.0);
    EXPECT_EQ(parallel_mollifier(x, 0.0).value, 1.0);
}

TEST(Proximity, MollifierHasItsGradient) {
    test::RandomPoints random(5);
    for (int i = 0; i < 50; ++i) {
        const FourPoints x = random.four(0);
        const double threshold = parallel_mollifier(x, 1.0).squared_cross * random.number(0.5, 4.0);
        const ParallelMollifier at = parallel_mollifier(x, threshold);
        const FourPoints gradient = squared_cross_gradient(x);
        for (int k = 0; k < 12; ++k) {
            const double step = 1e-5;
            FourPoints up = x, down = x;
            up[k / 3][k % 3] += step;
            down[k / 3][k % 3] -= step;
            const ParallelMollifier a = parallel_mollifier(up, threshold), b = parallel_mollifier(down, threshold);
            EXPECT_NEAR((a.squared_cross - b.squared_cross) / (2.0 * step), gradient[k / 3][k % 3],
                        1e-7 * (1.0 + at.squared_cross));
            if (std::abs(at.squared_cross / threshold - 1.0) > 0.01) {
                EXPECT_NEAR((a.value - b.value) / (2.0 * step), at.slope * gradient[k / 3][k % 3],
                            1e-7 / std::min(1.0, threshold));
            }
        }
    }
}

}  // namespace
}  // namespace toile::simulate
