#include "simulate/crossings.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>

#include "cloth/error.h"

namespace toile::simulate {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_d<double, 3, CGAL::Box_intersection_d::ID_NONE>;

/// A box that knows whose it is.
struct TriangleBox : Box {
    TriangleBox(const CGAL::Bbox_3& box, int from) : Box(box), owner(from) {}
    int id() const { return owner; }
    int owner;
};

std::vector<TriangleBox> triangle_boxes(const Triangles& triangle, const std::vector<Point>& point) {
    std::vector<TriangleBox> boxes;
    boxes.reserve(triangle.rows());
    for (int f = 0; f < triangle.rows(); ++f)
        boxes.emplace_back(point[triangle(f, 0)].bbox() + point[triangle(f, 1)].bbox() + point[triangle(f, 2)].bbox(),
                           f);
    return boxes;
}

bool share_a_vertex(const Topology& topology, int e, const Triangles& triangle, int f) {
    for (int corner = 0; corner < 3; ++corner)
        if (triangle(f, corner) == topology.edge(e, 0) || triangle(f, corner) == topology.edge(e, 1)) return true;
    return false;
}

bool cross(const Point& a, const Point& b, const Point& p, const Point& q, const Point& r) {
    const CGAL::Orientation side_a = CGAL::orientation(p, q, r, a), side_b = CGAL::orientation(p, q, r, b);
    if (side_a == side_b && side_a != CGAL::COPLANAR) return false;
    return CGAL::do_intersect(Kernel::Triangle_3(p, q, r), Kernel::Segment_3(a, b));
}

}  // namespace

std::vector<Crossing> find_crossings(const Triangles& triangle, const Topology& topology, const Positions& position) {
    if (!position.allFinite()) throw Error("crossings of a mesh with positions that are not finite");
    std::vector<Point> point;
    point.reserve(position.rows());
    for (int v = 0; v < position.rows(); ++v) point.emplace_back(position(v, 0), position(v, 1), position(v, 2));

    std::vector<Crossing> found;
    // An edge lies in the boxes of both of its triangles: it is tested with the first of them only.
    const auto test_edges_of = [&](int owner, int f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int e = topology.triangle_edge(owner, corner);
            if (topology.edge_triangle(e, 0) != owner || share_a_vertex(topology, e, triangle, f)) continue;
            if (cross(point[topology.edge(e, 0)], point[topology.edge(e, 1)], point[triangle(f, 0)],
                      point[triangle(f, 1)], point[triangle(f, 2)]))
                found.push_back({e, f});
        }
    };
    std::vector<TriangleBox> boxes = triangle_boxes(triangle, point);
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const TriangleBox& a, const TriangleBox& b) {
        test_edges_of(a.owner, b.owner);
        test_edges_of(b.owner, a.owner);
    });
    std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
    });
    return found;
}

}  // namespace toile::simulate
