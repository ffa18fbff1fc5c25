#include "simulate/body_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "cloth/error.h"
#include "simulate/crossings.h"
#include "skin/surface_query.h"

namespace toile::simulate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_handle_d<double, 3, const Kernel::Triangle_3*>;

std::vector<Kernel::Triangle_3> kernel_triangles(const Triangles& triangle, const Positions& position) {
    const auto point = [&](int v) { return Kernel::Point_3(position(v, 0), position(v, 1), position(v, 2)); };
    std::vector<Kernel::Triangle_3> made;
    made.reserve(static_cast<size_t>(triangle.rows()));
    for (int f = 0; f < triangle.rows(); ++f) {
        made.emplace_back(point(triangle(f, 0)), point(triangle(f, 1)), point(triangle(f, 2)));
        if (made.back().is_degenerate()) made.pop_back();
    }
    return made;
}

std::vector<Box> boxes_of(const std::vector<Kernel::Triangle_3>& triangle) {
    std::vector<Box> box;
    box.reserve(triangle.size());
    for (const Kernel::Triangle_3& one : triangle) box.emplace_back(one.bbox(), &one);
    return box;
}

/// The regions of a surface that the crossed edges cut it into, and which of them lie inside it.
class Regions {
  public:
    Regions(const skin::Body& body, const Topology& topology, const Positions& position,
            const std::vector<Crossing>& crossing)
        : body_(body), topology_(topology), position_(position), root_(static_cast<size_t>(body.vertex_count())) {
        for (size_t v = 0; v < root_.size(); ++v) root_[v] = static_cast<int>(v);
        std::vector<bool> cut(static_cast<size_t>(topology.edge.rows()), false);
        for (const Crossing& one : crossing) cut[one.edge] = true;
        for (int e = 0; e < topology.edge.rows(); ++e)
            if (!cut[e]) root_[find(topology.edge(e, 0))] = find(topology.edge(e, 1));
        classify(crossing, cut);
    }

    bool buried(int v) const { return buried_[static_cast<size_t>(v)]; }

  private:
    int find(int v) {
        while (root_[v] != v) v = root_[v] = root_[root_[v]];
        return v;
    }

    void classify(const std::vector<Crossing>& crossing, const std::vector<bool>& cut);
    bool inside(const skin::SurfaceQuery& query, const Positions& normal, int v) const;

    const skin::Body& body_;
    const Topology& topology_;
    const Positions& position_;
    std::vector<int> root_;
    std::vector<bool> buried_;
};

/// Just outside the vertex's own sheet the winding number is that of the other sheets.
bool Regions::inside(const skin::SurfaceQuery& query, const Positions& normal, int v) const {
    constexpr double off_the_sheet = 1e-4;  // [m]
    return query.winding_number((position_.row(v) + off_the_sheet * normal.row(v)).transpose()) > 0.5;
}

void Regions::classify(const std::vector<Crossing>& crossing, const std::vector<bool>& cut) {
    const size_t vertices = root_.size();
    buried_.assign(vertices, false);
    if (crossing.empty()) return;
    std::vector<bool> beside(vertices, false);  // ends of crossed edges: their normals are the least to be trusted
    for (int e = 0; e < topology_.edge.rows(); ++e)
        if (cut[e]) beside[topology_.edge(e, 0)] = beside[topology_.edge(e, 1)] = true;
    std::vector<bool> asked(vertices, false);
    for (const Crossing& one : crossing) {
        for (int end = 0; end < 2; ++end) asked[find(topology_.edge(one.edge, end))] = true;
        for (int corner = 0; corner < 3; ++corner) asked[find(body_.triangle(one.triangle, corner))] = true;
    }
    std::vector<int> witness(vertices, -1);
    for (size_t v = 0; v < vertices; ++v) {
        int& one = witness[find(static_cast<int>(v))];
        if (one < 0 || (beside[one] && !beside[v])) one = static_cast<int>(v);
    }
    const skin::SurfaceQuery query(body_.triangle, position_);
    const Positions normal = vertex_normals(body_.triangle, position_);
    std::vector<bool> region_buried(vertices, false);
    for (size_t v = 0; v < vertices; ++v)
        if (asked[v]) region_buried[v] = inside(query, normal, witness[v]);
    for (size_t v = 0; v < vertices; ++v) buried_[v] = region_buried[find(static_cast<int>(v))];
}

/// Where an edge crosses a triangle's plane.
Eigen::RowVector3d crossing_point(const skin::Body& body, const Topology& topology, const Positions& x,
                                  const Crossing& one) {
    const Eigen::RowVector3d a = x.row(topology.edge(one.edge, 0)), b = x.row(topology.edge(one.edge, 1));
    const Eigen::RowVector3d p = x.row(body.triangle(one.triangle, 0));
    const Eigen::RowVector3d normal =
        (x.row(body.triangle(one.triangle, 1)) - p).cross(x.row(body.triangle(one.triangle, 2)) - p);
    const double from = normal.dot(a - p), to = normal.dot(b - p);
    return a + (from == to ? 0.5 : from / (from - to)) * (b - a);
}

/// Points known to be on the joined surface.
class JoinedSurface {
  public:
    JoinedSurface(const skin::Body& body, const Topology& topology, const Positions& x, const Regions& region,
                  const std::vector<Crossing>& crossing) {
        std::vector<int> kept;
        for (int f = 0; f < body.triangle.rows(); ++f)
            if (!region.buried(body.triangle(f, 0)) && !region.buried(body.triangle(f, 1)) &&
                !region.buried(body.triangle(f, 2)))
                kept.push_back(f);
        for (const Crossing& one : crossing) contour_.push_back(crossing_point(body, topology, x, one));
        if (kept.empty()) return;
        const Triangles outer = body.triangle(kept, Eigen::all);
        query_.emplace(outer, x);
    }

    double distance(const Eigen::RowVector3d& point) const {
        double nearest = query_ ? query_->nearest(point.transpose()).distance : std::numeric_limits<double>::infinity();
        for (const Eigen::RowVector3d& one : contour_) nearest = std::min(nearest, (one - point).norm());
        return nearest;
    }

  private:
    std::optional<skin::SurfaceQuery> query_;
    std::vector<Eigen::RowVector3d> contour_;
};

/// The crossings of the pose that the rest pose does not have; both are sorted.
std::vector<Crossing> fresh(const std::vector<Crossing>& posed, const std::vector<Crossing>& rest) {
    const auto less = [](const Crossing& a, const Crossing& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
    };
    std::vector<Crossing> left;
    std::set_difference(posed.begin(), posed.end(), rest.begin(), rest.end(), std::back_inserter(left), less);
    return left;
}

}  // namespace

int count_crossing_pairs(const Triangles& a, const Positions& position_a, const Triangles& b,
                         const Positions& position_b) {
    if (!position_a.allFinite() || !position_b.allFinite())
        throw Error("crossings of surfaces with positions that are not finite");
    const std::vector<Kernel::Triangle_3> first = kernel_triangles(a, position_a),
                                          second = kernel_triangles(b, position_b);
    std::vector<Box> first_box = boxes_of(first), second_box = boxes_of(second);
    int count = 0;
    CGAL::box_intersection_d(first_box.begin(), first_box.end(), second_box.begin(), second_box.end(),
                             [&](const Box& one, const Box& other) {
                                 if (CGAL::do_intersect(*one.handle(), *other.handle())) ++count;
                             });
    return count;
}

BodyIntersection body_self_intersection(const skin::Body& body, const Positions& posed, const Positions& cloth) {
    const Topology topology = build_topology(body.triangle);
    const std::vector<Crossing> at_rest = find_crossings(body.triangle, topology, body.rest_position);
    const std::vector<Crossing> now = find_crossings(body.triangle, topology, posed);
    BodyIntersection found;
    found.crossings = static_cast<int>(fresh(now, at_rest).size());
    if (found.crossings == 0) return found;
    const Regions before(body, topology, body.rest_position, at_rest), after(body, topology, posed, now);
    const JoinedSurface joined(body, topology, posed, after, now);
    for (int v = 0; v < body.vertex_count(); ++v) {
        if (!after.buried(v) || before.buried(v)) continue;
        const double depth = joined.distance(posed.row(v));
        if (depth <= found.depth) continue;
        const double to_cloth = std::sqrt((cloth.rowwise() - posed.row(v)).rowwise().squaredNorm().minCoeff());
        if (!(to_cloth <= garment_reach + depth)) continue;
        found.depth = depth;
        found.place = posed.row(v).transpose();
    }
    return found;
}

}  // namespace toile::simulate
