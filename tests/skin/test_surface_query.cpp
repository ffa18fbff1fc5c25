#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "skin/surface_query.h"

namespace toile::skin {
namespace {

struct Mesh {
    Triangles triangle;
    Positions position;
};

/// A closed bumpy ball with concave and convex creases, from a latitude-longitude grid.
Mesh bumpy_ball(int rings, int sectors) {
    Mesh mesh;
    mesh.position.resize(2 + (rings - 1) * sectors, 3);
    mesh.position.row(0) << 0, 1, 0;
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j < sectors; ++j) {
            const double polar = std::numbers::pi * i / rings, around = 2 * std::numbers::pi * j / sectors;
            const double radius = 1.0 + 0.3 * std::sin(4 * around) * std::sin(polar) + 0.2 * std::cos(5 * polar);
            mesh.position.row(1 + (i - 1) * sectors + j) << radius * std::sin(polar) * std::sin(around),
                radius * std::cos(polar), radius * std::sin(polar) * std::cos(around);
        }
    }
    mesh.position.row(mesh.position.rows() - 1) << 0, -1.2, 0;
    std::vector<Eigen::RowVector3i> rows;
    const int last = static_cast<int>(mesh.position.rows()) - 1;
    auto at = [&](int i, int j) { return 1 + (i - 1) * sectors + j % sectors; };
    for (int j = 0; j < sectors; ++j) {
        rows.emplace_back(0, at(1, j), at(1, j + 1));
        for (int i = 1; i + 1 < rings; ++i) {
            rows.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            rows.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
        rows.emplace_back(at(rings - 1, j), last, at(rings - 1, j + 1));
    }
    mesh.triangle.resize(static_cast<int>(rows.size()), 3);
    for (size_t f = 0; f < rows.size(); ++f) mesh.triangle.row(static_cast<int>(f)) = rows[f];
    return mesh;
}

Mesh cube() {
    Mesh mesh;
    mesh.position.resize(8, 3);
    for (int v = 0; v < 8; ++v) mesh.position.row(v) << (v & 1), (v >> 1 & 1), (v >> 2 & 1);
    mesh.triangle.resize(12, 3);
    mesh.triangle << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
        3, 7, 5;
    return mesh;
}

std::vector<Eigen::Vector3d> random_points(int count, double range) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> coordinate(-range, range);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    return points;
}

/// The distance to one triangle by dense refinement of the quadratic over its barycentric square: independent of the
/// code under test.
double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
    Eigen::Vector3d weight(1.0 / 3, 1.0 / 3, 1.0 / 3);
    double best = std::numeric_limits<double>::infinity(), reach = 1.0;
    for (int round = 0; round < 60; ++round, reach *= 0.7) {
        const Eigen::Vector3d center = weight;
        for (int i = -4; i <= 4; ++i) {
            for (int j = -4; j <= 4; ++j) {
                Eigen::Vector3d w(center[0] + reach * i / 4, center[1] + reach * j / 4, 0);
                w[0] = std::clamp(w[0], 0.0, 1.0);
                w[1] = std::clamp(w[1], 0.0, 1.0 - w[0]);
                w[2] = 1.0 - w[0] - w[1];
                const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
                if (distance < best) {
                    best = distance;
                    weight = w;
                }
            }
        }
    }
    return best;
}

double brute_distance(const Mesh& mesh, const Eigen::Vector3d& p) {
    double best = std::numeric_limits<double>::infinity();
    for (int f = 0; f < mesh.triangle.rows(); ++f)
        best = std::min(
            best, distance_to_triangle(p, mesh.position.row(mesh.triangle(f, 0)),
                                       mesh.position.row(mesh.triangle(f, 1)), mesh.position.row(mesh.triangle(f, 2))));
    return best;
}

TEST(SurfaceQuery, distance_agrees_with_brute_force) {
    const Mesh mesh = bumpy_ball(6, 8);
    const SurfaceQuery query(mesh.triangle, mesh.position);
    for (const Eigen::Vector3d& p : random_points(25, 1.6))
        EXPECT_NEAR(query.nearest(p).distance, brute_distance(mesh, p), 1e-7);
}

TEST(SurfaceQuery, barycentrics_give_the_nearest_position) {
    const Mesh mesh = bumpy_ball(12, 16);
    const SurfaceQuery query(mesh.triangle, mesh.position);
    for (const Eigen::Vector3d& p : random_points(300, 1.6)) {
        const SurfaceQuery::Nearest nearest = query.nearest(p);
        EXPECT_GE(nearest.barycentric.minCoeff(), 0.0);
        EXPECT_NEAR(nearest.barycentric.sum(), 1.0, 1e-14);
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k)
            at += nearest.barycentric[k] * mesh.position.row(mesh.triangle(nearest.triangle, k)).transpose();
        EXPECT_LT((at - nearest.position).norm(), 1e-14);
        EXPECT_NEAR((p - at).norm(), nearest.distance, 1e-14);
    }
}

TEST(SurfaceQuery, sign_agrees_with_the_winding_number) {
    const Mesh mesh = bumpy_ball(12, 16);
    const SurfaceQuery query(mesh.triangle, mesh.position);
    int inside = 0;
    for (const Eigen::Vector3d& p : random_points(2000, 1.6)) {
        const SurfaceQuery::Nearest nearest = query.nearest(p);
        const double winding = query.winding_number(p);
        EXPECT_NEAR(winding, std::round(winding), 1e-9);
        EXPECT_EQ(nearest.signed_distance<0.0, winding> 0.5) << p.transpose();
        EXPECT_EQ(std::abs(nearest.signed_distance), nearest.distance);
        inside += winding > 0.5;
    }
    EXPECT_GT(inside, 200);
    EXPECT_LT(inside, 1800);
}

TEST(SurfaceQuery, known_distances_of_a_cube) {
    const Mesh mesh = cube();
    const SurfaceQuery query(mesh.triangle, mesh.position);
    EXPECT_NEAR(query.nearest({0.5, 0.5, 0.9}).signed_distance, -0.1, 1e-15);        // face
    EXPECT_NEAR(query.nearest({2, 2, 0.5}).signed_distance, std::sqrt(2.0), 1e-15);  // edge
    EXPECT_NEAR(query.nearest({2, 2, 2}).signed_distance, std::sqrt(3.0), 1e-15);    // corner
    EXPECT_EQ(query.nearest({2, 2, 2}).position, Eigen::Vector3d(1, 1, 1));
    EXPECT_NEAR(query.winding_number({0.5, 0.4, 0.3}), 1.0, 1e-12);
    EXPECT_NEAR(query.winding_number({1.5, 0.4, 0.3}), 0.0, 1e-12);
}

TEST(SurfaceQuery, open_surface_has_a_part_of_the_solid_angle) {
    Mesh mesh = cube();
    mesh.triangle.conservativeResize(10, 3);  // the side x = 1 is away
    const SurfaceQuery query(mesh.triangle, mesh.position);
    EXPECT_NEAR(query.winding_number({0.5, 0.5, 0.5}), 5.0 / 6.0, 1e-12);
    EXPECT_NEAR(query.nearest({0.5, 0.5, 0.9}).signed_distance, -0.1, 1e-15);
}

TEST(SurfaceQuery, vertices_split_along_seams_keep_the_sign) {
    const Mesh joined = cube();
    Mesh split;  // each triangle has its own three vertices
    split.position.resize(36, 3);
    split.triangle.resize(12, 3);
    for (int f = 0; f < 12; ++f) {
        for (int k = 0; k < 3; ++k) {
            split.triangle(f, k) = 3 * f + k;
            split.position.row(3 * f + k) = joined.position.row(joined.triangle(f, k));
        }
    }
    const SurfaceQuery one(joined.triangle, joined.position), other(split.triangle, split.position);
    for (const Eigen::Vector3d& p : random_points(300, 3.0))
        EXPECT_NEAR(one.nearest(p).signed_distance, other.nearest(p).signed_distance, 1e-15);
}

TEST(SurfaceQuery, triangles_without_area_do_no_harm) {
    Mesh mesh = cube();
    const SurfaceQuery sound(mesh.triangle, mesh.position);
    mesh.triangle.conservativeResize(14, 3);
    mesh.triangle.row(12) << 0, 1, 1;
    mesh.triangle.row(13) << 5, 5, 5;
    const SurfaceQuery query(mesh.triangle, mesh.position);
    for (const Eigen::Vector3d& p : random_points(100, 3.0))
        EXPECT_NEAR(query.nearest(p).signed_distance, sound.nearest(p).signed_distance, 1e-15);
}

TEST(SurfaceQuery, a_surface_without_area_is_refused) {
    Mesh mesh = cube();
    mesh.position.setZero();
    EXPECT_THROW(SurfaceQuery(mesh.triangle, mesh.position), Error);
    EXPECT_THROW(SurfaceQuery(Triangles(0, 3), mesh.position), Error);
}

TEST(SurfaceQuery, queries_from_several_threads_give_the_same) {
    const Mesh mesh = bumpy_ball(24, 32);
    const SurfaceQuery query(mesh.triangle, mesh.position);
    const std::vector<Eigen::Vector3d> points = random_points(1000, 1.6);
    std::vector<double> threaded(points.size());
    parallel_for(static_cast<int>(points.size()), 4,
                 [&](int, int i) { threaded[i] = query.nearest(points[i]).signed_distance; });
    for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(threaded[i], query.nearest(points[i]).signed_distance);
}

}  // namespace
}  // namespace toile::skin
