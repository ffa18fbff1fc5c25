#include "skin/surface_query.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::skin {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using TriangleIterator = std::vector<Kernel::Triangle_3>::const_iterator;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, TriangleIterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Corners = std::array<Eigen::Vector3d, 3>;

/// Weights of the corners at the point of segment (a, b) nearest to p, as the weight of b.
double segment_weight(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const double squared_length = (b - a).squaredNorm();
    return squared_length > 0.0 ? std::clamp((p - a).dot(b - a) / squared_length, 0.0, 1.0) : 0.0;
}

/// Barycentric weights of the nearest point of a triangle; exact zeros tell on which edge or corner it lies.
Eigen::Vector3d nearest_barycentric(const Eigen::Vector3d& p, const Corners& corner) {
    const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double squared_norm = normal.squaredNorm();
    Eigen::Vector3d weight;
    bool inside = squared_norm > 0.0;
    for (int k = 0; inside && k < 3; ++k) {
        const Eigen::Vector3d &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
        weight[k] = (b - a).cross(p - a).dot(normal) / squared_norm;
        inside = weight[k] > 0.0;
    }
    if (inside) return weight / weight.sum();
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const double t = segment_weight(p, corner[k], corner[next]);
        const double squared_distance = ((1.0 - t) * corner[k] + t * corner[next] - p).squaredNorm();
        if (squared_distance >= best) continue;
        best = squared_distance;
        weight.setZero();
        weight[k] = 1.0 - t;
        weight[next] = t;
    }
    return weight;
}

/// Vertices at exactly the same place share one number, so that a surface split along texture seams has no false
/// borders.
Triangles joined_by_position(const Triangles& triangle, const Positions& position) {
    std::map<std::array<double, 3>, int> first;
    std::vector<int> number(static_cast<size_t>(position.rows()));
    for (int v = 0; v < position.rows(); ++v)
        number[v] = first.try_emplace({position(v, 0), position(v, 1), position(v, 2)}, v).first->second;
    return triangle.unaryExpr([&](int v) { return number[v]; });
}

}  // namespace

struct SurfaceQuery::Impl {
    Triangles triangle;          // joined by position
    Positions position;          // of the joined vertices' indices
    Triangles triangle_edge;     // edge opposite each corner
    Positions face_normal;       // unit
    Positions edge_normal;       // sums of the faces' normals
    Positions vertex_normal;     // angle-weighted
    std::vector<int> tree_face;  // triangle of each primitive: those without area are left out
    std::vector<Kernel::Triangle_3> tree_triangle;
    Tree tree;

    Impl(const Triangles& triangles, const Positions& positions)
        : triangle(joined_by_position(triangles, positions)), position(positions) {
        build_normals();
        build_tree();
    }

    Corners corners(int f) const {
        return {position.row(triangle(f, 0)), position.row(triangle(f, 1)), position.row(triangle(f, 2))};
    }

    void build_normals() {
        const Topology topology = build_topology(triangle);
        triangle_edge = topology.triangle_edge;
        face_normal = Positions::Zero(triangle.rows(), 3);
        edge_normal = Positions::Zero(topology.edge.rows(), 3);
        vertex_normal = vertex_normals(triangle, position);
        for (int f = 0; f < triangle.rows(); ++f) {
            const Corners corner = corners(f);
            const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
            if (!(normal.norm() > 0.0)) continue;
            face_normal.row(f) = normal.normalized().transpose();
            for (int k = 0; k < 3; ++k) edge_normal.row(triangle_edge(f, k)) += face_normal.row(f);
        }
    }

    void build_tree() {
        for (int f = 0; f < triangle.rows(); ++f) {
            if (face_normal.row(f).isZero(0.0)) continue;
            const Corners c = corners(f);
            tree_face.push_back(f);
            tree_triangle.emplace_back(Point(c[0].x(), c[0].y(), c[0].z()), Point(c[1].x(), c[1].y(), c[1].z()),
                                       Point(c[2].x(), c[2].y(), c[2].z()));
        }
        if (tree_face.empty()) throw Error("the surface has no triangle with an area");
        tree.insert(tree_triangle.cbegin(), tree_triangle.cend());
        // Both are built on first use otherwise, which would make const queries write.
        tree.build();
        tree.accelerate_distance_queries();
    }

    Eigen::Vector3d pseudonormal(int f, const Eigen::Vector3d& barycentric) const {
        for (int k = 0; k < 3; ++k)
            if (barycentric[k] == 1.0) return vertex_normal.row(triangle(f, k));
        for (int k = 0; k < 3; ++k)
            if (barycentric[k] == 0.0) return edge_normal.row(triangle_edge(f, k));
        return face_normal.row(f);
    }
};

SurfaceQuery::SurfaceQuery(const Triangles& triangle, const Positions& position)
    : impl_(std::make_unique<Impl>(triangle, position)) {}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;

SurfaceQuery::Nearest SurfaceQuery::nearest(const Eigen::Vector3d& point) const {
    const auto found = impl_->tree.closest_point_and_primitive(Point(point.x(), point.y(), point.z()));
    Nearest nearest;
    nearest.triangle = impl_->tree_face[found.second - impl_->tree_triangle.cbegin()];
    const Corners corner = impl_->corners(nearest.triangle);
    nearest.barycentric = nearest_barycentric(point, corner);
    nearest.position =
        nearest.barycentric[0] * corner[0] + nearest.barycentric[1] * corner[1] + nearest.barycentric[2] * corner[2];
    const Eigen::Vector3d away = point - nearest.position;
    nearest.distance = away.norm();
    // Baerentzen and Aanaes 2005: the only normal whose sign is right at edges and corners too.
    const bool inside = away.dot(impl_->pseudonormal(nearest.triangle, nearest.barycentric)) < 0.0;
    nearest.signed_distance = inside ? -nearest.distance : nearest.distance;
    return nearest;
}

double SurfaceQuery::winding_number(const Eigen::Vector3d& point) const {
    double solid_angle = 0.0;
    for (int f = 0; f < impl_->triangle.rows(); ++f) {
        // Van Oosterom and Strackee 1983.
        Corners c = impl_->corners(f);
        for (Eigen::Vector3d& corner : c) corner -= point;
        const double length[3] = {c[0].norm(), c[1].norm(), c[2].norm()};
        const double volume = c[0].dot(c[1].cross(c[2]));
        const double denominator = length[0] * length[1] * length[2] + c[0].dot(c[1]) * length[2] +
                                   c[1].dot(c[2]) * length[0] + c[2].dot(c[0]) * length[1];
        solid_angle += 2.0 * std::atan2(volume, denominator);
    }
    return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace toile::skin
