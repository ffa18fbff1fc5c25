#include "pattern/panel_mesh.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Random.h>
#include <CGAL/lloyd_optimize_mesh_2.h>

#include <algorithm>
#include <array>
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

/// Rounded to 0.1 micrometres: the last bits of CGAL's result depend on where its faces lie in memory.
double settled(double coordinate) {
    return std::ldexp(std::round(std::ldexp(coordinate, 23)), -23);
}

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

Triangulation triangulate(const PlanePositions& boundary, const CGAL::Polygon_2<Kernel>& polygon, double edge_length) {
    // CGAL orders its insertions by a generator that is seeded by the clock otherwise.
    CGAL::get_default_random() = CGAL::Random(1);
    Triangulation mesh;
    mesh.insert_constraint(polygon.vertices_begin(), polygon.vertices_end(), true);
    const std::vector<Point> inside = lattice(boundary, polygon, edge_length);
    mesh.insert(inside.begin(), inside.end());
    // Only marks what lies inside the polygon: criteria that hold for every triangle add no point.
    CGAL::Delaunay_mesher_2<Triangulation, CGAL::Delaunay_mesh_size_criteria_2<Triangulation>> mesher(
        mesh, CGAL::Delaunay_mesh_size_criteria_2<Triangulation>(0.0, 0.0));
    mesher.mark_facets();
    CGAL::lloyd_optimize_mesh_2(mesh, CGAL::parameters::max_iteration_number = 30);
    return mesh;
}

}  // namespace

PanelMesh mesh_panel(const PlanePositions& boundary, double edge_length) {
    CGAL::Polygon_2<Kernel> polygon;
    std::map<std::array<double, 2>, int> number;
    for (int i = 0; i < boundary.rows(); ++i) {
        polygon.push_back(Point(boundary(i, 0), boundary(i, 1)));
        number.try_emplace({boundary(i, 0), boundary(i, 1)}, i);
    }
    if (boundary.rows() < 3 || !CGAL::is_simple_2(polygon.vertices_begin(), polygon.vertices_end(), Kernel{}) ||
        !polygon.is_counterclockwise_oriented())
        throw Error("a pattern panel's outline crosses itself");
    const Triangulation mesh = triangulate(boundary, polygon, edge_length);

    PanelMesh panel;
    std::vector<std::array<double, 2>> inside;
    for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v)
        if (!number.contains({v->point().x(), v->point().y()})) inside.push_back({v->point().x(), v->point().y()});
    std::sort(inside.begin(), inside.end(), [](const auto& a, const auto& b) {
        return std::make_pair(settled(a[1]), settled(a[0])) < std::make_pair(settled(b[1]), settled(b[0]));
    });
    panel.position.resize(boundary.rows() + static_cast<int>(inside.size()), 2);
    panel.position.topRows(boundary.rows()) = boundary;
    for (size_t i = 0; i < inside.size(); ++i) {
        const int row = static_cast<int>(boundary.rows() + i);
        panel.position.row(row) << settled(inside[i][0]), settled(inside[i][1]);
        number.emplace(inside[i], row);
    }
    std::vector<Eigen::RowVector3i> rows;
    for (auto f = mesh.finite_faces_begin(); f != mesh.finite_faces_end(); ++f) {
        if (!f->is_in_domain()) continue;
        Eigen::RowVector3i& row = rows.emplace_back();
        for (int k = 0; k < 3; ++k) row[k] = number.at({f->vertex(k)->point().x(), f->vertex(k)->point().y()});
        while (row[0] != row.minCoeff()) row = Eigen::RowVector3i(row[1], row[2], row[0]);
    }
    std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
        return std::make_tuple(a[0], a[1], a[2]) < std::make_tuple(b[0], b[1], b[2]);
    });
    panel.triangle.resize(static_cast<int>(rows.size()), 3);
    for (size_t f = 0; f < rows.size(); ++f) panel.triangle.row(static_cast<int>(f)) = rows[f];
    return panel;
}

}  // namespace toile::pattern
