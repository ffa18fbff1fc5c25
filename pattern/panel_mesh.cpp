#include "pattern/panel_mesh.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "cloth/error.h"

namespace toile::pattern {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Data = CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                                  CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data>;

/// Rounds of smoothing: more change the worst angle by less than a degree.
constexpr int smoothing_rounds = 30;

double distance_to_boundary(const Eigen::RowVector2d& p, const PlanePositions& boundary) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < boundary.rows(); ++i) {
        const Eigen::RowVector2d a = boundary.row(i), side = boundary.row((i + 1) % boundary.rows()) - a;
        const double t = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (a + t * side - p).norm());
    }
    return nearest;
}

/// A hexagonal lattice inside the polygon, centred on it so that a symmetric panel gets symmetric points.
std::vector<Point> lattice(const PlanePositions& boundary, const CGAL::Polygon_2<Kernel>& polygon, double edge_length) {
    const Eigen::RowVector2d lower = boundary.colwise().minCoeff(), upper = boundary.colwise().maxCoeff();
    const Eigen::RowVector2d center = 0.5 * (lower + upper);
    const double row_height = edge_length * std::sqrt(0.75);
    const int rows = static_cast<int>((upper.y() - lower.y()) / row_height) / 2 + 1;
    const int columns = static_cast<int>((upper.x() - lower.x()) / edge_length) / 2 + 2;
    std::vector<Point> points;
    for (int i = -rows; i <= rows; ++i) {
        for (int j = -columns; j <= columns; ++j) {
            const Eigen::RowVector2d p = center + Eigen::RowVector2d((j + 0.5 * (i & 1)) * edge_length, i * row_height);
            if (polygon.bounded_side(Point(p.x(), p.y())) != CGAL::ON_BOUNDED_SIDE) continue;
            if (distance_to_boundary(p, boundary) > 0.6 * edge_length) points.emplace_back(p.x(), p.y());
        }
    }
    return points;
}

/// The triangles of the constrained Delaunay triangulation of the outline and the points inside it, the outline's
/// points first, each from its smallest index, sorted. Points go in one after the other: nothing depends on where CGAL
/// keeps them.
std::vector<Eigen::RowVector3i> triangulate(const PlanePositions& boundary, const std::vector<Point>& inside) {
    Triangulation mesh;
    std::vector<Triangulation::Vertex_handle> handle;
    std::map<Triangulation::Vertex_handle, int> number;  // looked up only
    const auto insert = [&](const Point& p) {
        handle.push_back(handle.empty() ? mesh.insert(p) : mesh.insert(p, handle.back()->face()));
        number.emplace(handle.back(), static_cast<int>(handle.size()) - 1);
    };
    const int corners = static_cast<int>(boundary.rows());
    for (int i = 0; i < corners; ++i) insert(Point(boundary(i, 0), boundary(i, 1)));
    for (const Point& p : inside) insert(p);
    for (int i = 0; i < corners; ++i) mesh.insert_constraint(handle[i], handle[(i + 1) % corners]);
    // Only marks what lies inside the polygon: criteria that hold for every triangle add no point.
    CGAL::Delaunay_mesher_2<Triangulation, CGAL::Delaunay_mesh_size_criteria_2<Triangulation>> mesher(
        mesh, CGAL::Delaunay_mesh_size_criteria_2<Triangulation>(0.0, 0.0));
    mesher.mark_facets();

    std::vector<Eigen::RowVector3i> rows;
    for (auto f = mesh.finite_faces_begin(); f != mesh.finite_faces_end(); ++f) {
        if (!f->is_in_domain()) continue;
        Eigen::RowVector3i& row = rows.emplace_back();
        for (int k = 0; k < 3; ++k) row[k] = number.at(f->vertex(k));
        while (row[0] != row.minCoeff()) row = Eigen::RowVector3i(row[1], row[2], row[0]);
    }
    std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
        return std::make_tuple(a[0], a[1], a[2]) < std::make_tuple(b[0], b[1], b[2]);
    });
    return rows;
}

/// Moves each inner point to the area-weighted mean of its triangles' centroids (Chen and Holst 2011, "Efficient mesh
/// optimization schemes based on optimal Delaunay triangulations"). CGAL's own smoothing sums in the order in which its
/// vertices lie in memory.
void smooth(const PlanePositions& boundary, const std::vector<Eigen::RowVector3i>& triangles,
            std::vector<Point>& inside) {
    const int corners = static_cast<int>(boundary.rows());
    const auto at = [&](int i) -> Eigen::RowVector2d {
        if (i < corners) return boundary.row(i);
        return {inside[i - corners].x(), inside[i - corners].y()};
    };
    std::vector<Eigen::RowVector2d> sum(inside.size(), Eigen::RowVector2d::Zero());
    std::vector<double> weight(inside.size(), 0.0);
    for (const Eigen::RowVector3i& t : triangles) {
        const Eigen::RowVector2d a = at(t[0]), b = at(t[1]), c = at(t[2]);
        const double area = std::abs((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
        for (int k = 0; k < 3; ++k) {
            if (t[k] < corners) continue;
            sum[t[k] - corners] += area / 3.0 * (a + b + c);
            weight[t[k] - corners] += area;
        }
    }
    for (size_t i = 0; i < inside.size(); ++i)
        if (weight[i] > 0.0) inside[i] = Point(sum[i].x() / weight[i], sum[i].y() / weight[i]);
}

}  // namespace

PanelMesh mesh_panel(const PlanePositions& boundary, double edge_length) {
    CGAL::Polygon_2<Kernel> polygon;
    for (int i = 0; i < boundary.rows(); ++i) polygon.push_back(Point(boundary(i, 0), boundary(i, 1)));
    if (boundary.rows() < 3 || !CGAL::is_simple_2(polygon.vertices_begin(), polygon.vertices_end(), Kernel{}) ||
        !polygon.is_counterclockwise_oriented())
        throw Error("a pattern panel's outline crosses itself");
    std::vector<Point> inside = lattice(boundary, polygon, edge_length);
    std::vector<Eigen::RowVector3i> rows = triangulate(boundary, inside);
    for (int round = 0; round < smoothing_rounds; ++round) {
        smooth(boundary, rows, inside);
        rows = triangulate(boundary, inside);
    }

    PanelMesh panel;
    panel.position.resize(boundary.rows() + static_cast<int>(inside.size()), 2);
    panel.position.topRows(boundary.rows()) = boundary;
    for (size_t i = 0; i < inside.size(); ++i)
        panel.position.row(static_cast<int>(boundary.rows() + i)) << inside[i].x(), inside[i].y();
    panel.triangle.resize(static_cast<int>(rows.size()), 3);
    for (size_t f = 0; f < rows.size(); ++f) panel.triangle.row(static_cast<int>(f)) = rows[f];
    return panel;
}

}  // namespace toile::pattern
