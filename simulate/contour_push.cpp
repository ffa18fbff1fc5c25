#include "simulate/contour_push.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace toile::simulate {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

Vector3d area_vector(const Triangles& triangle, int f, const Positions& x) {
    const Vector3d p = x.row(triangle(f, 0)), q = x.row(triangle(f, 1)), r = x.row(triangle(f, 2));
    return (q - p).cross(r - p);
}

/// Sum of the area vectors of an edge's triangles.
Vector3d edge_normal(const Triangles& triangle, const Topology& topology, int e, const Positions& x) {
    Vector3d sum = Vector3d::Zero();
    for (int side = 0; side < 2; ++side)
        if (const int f = topology.edge_triangle(e, side); f >= 0) sum += area_vector(triangle, f, x);
    return sum;
}

/// Which way an edge has to go, relative to the triangle, to shorten its contour most per way: equation (3) of Volino
/// and Magnenat-Thalmann. Zero where it is not defined.
Vector3d contour_gradient(const Triangles& triangle, const Topology& topology, const Crossing& crossing,
                          const Vector3d& normal, const Positions& x) {
    const Vector3d a = x.row(topology.edge(crossing.edge, 0)), b = x.row(topology.edge(crossing.edge, 1));
    const double length = (b - a).norm();
    Vector3d gradient = Vector3d::Zero();
    if (!(length > 0.0)) return gradient;
    const Vector3d along = (b - a) / length;
    const double least_steepness = 0.1;  // an edge almost in the plane would be sent far away
    const double steepness = along.dot(normal);
    for (int side = 0; side < 2; ++side) {
        const int f = topology.edge_triangle(crossing.edge, side);
        if (f < 0) continue;
        int corner = 0;
        while (topology.triangle_edge(f, corner) != crossing.edge) ++corner;
        const Vector3d to_corner = x.row(triangle(f, corner)).transpose() - a;
        const Vector3d inward = to_corner - along.dot(to_corner) * along;
        Vector3d contour = normal.cross(along.cross(inward));
        const double norm = contour.norm();
        if (!(norm > 0.0)) continue;
        contour *= (contour.dot(inward) > 0.0 ? 1.0 : -1.0) / norm;
        gradient += contour - along.dot(contour) /
                                  std::copysign(std::max(std::abs(steepness), least_steepness), steepness) * normal;
    }
    return gradient;
}

}  // namespace

Passage passage(const Triangles& triangle, const Topology& topology, const Crossing& crossing, const Positions& x) {
    const Vector3d p = x.row(triangle(crossing.triangle, 0)), q = x.row(triangle(crossing.triangle, 1)),
                   r = x.row(triangle(crossing.triangle, 2)), a = x.row(topology.edge(crossing.edge, 0)),
                   b = x.row(topology.edge(crossing.edge, 1));
    Passage passage{Vector3d::Zero(), Vector3d::Constant(1.0 / 3.0), 0.5, Vector2d::Zero()};
    const Vector3d area = (q - p).cross(r - p);
    const double twice_area = area.norm();
    if (!(twice_area > 1e-300)) return passage;
    passage.normal = area / twice_area;
    passage.height << passage.normal.dot(a - p), passage.normal.dot(b - p);
    const double drop = passage.height[0] - passage.height[1];
    if (std::abs(drop) > 1e-300) passage.along = std::clamp(passage.height[0] / drop, 0.0, 1.0);
    const Vector3d point = (1.0 - passage.along) * a + passage.along * b;
    const Vector3d weight =
        Vector3d(passage.normal.dot((q - point).cross(r - point)), passage.normal.dot((r - point).cross(p - point)),
                 passage.normal.dot((p - point).cross(q - point)))
            .cwiseMax(0.0);
    if (weight.sum() > 0.0) passage.point_weight = weight / weight.sum();
    return passage;
}

ContourPush::ContourPush(const Triangles& triangle, const Topology& topology, const VertexRing& ring,
                         const std::vector<bool>& free)
    : triangle_(triangle),
      topology_(topology),
      free_(free),
      component_(connected_components(triangle, static_cast<int>(free.size()))),
      pieces_(topology, ring, component_),
      pushed_(free.size(), false) {}

/// From the point of one edge that is nearest to another, to that one's.
ContourPush::Plan ContourPush::swap_with(int edge, int other, const Positions& x) const {
    const Vector3d a = x.row(topology_.edge(edge, 0)), b = x.row(topology_.edge(edge, 1)),
                   c = x.row(topology_.edge(other, 0)), d = x.row(topology_.edge(other, 1));
    const Vector3d u = b - a, v = d - c, w = a - c;
    const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), uw = u.dot(w), vw = v.dot(w);
    const double determinant = uu * vv - uv * uv;
    double s = determinant > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0) : 0.5;
    const double t = vv > 0.0 ? std::clamp((uv * s + vw) / vv, 0.0, 1.0) : 0.0;
    if (uu > 0.0) s = std::clamp((uv * t - uw) / uu, 0.0, 1.0);
    return {Way::swap, other, s, t, ((c + t * v) - (a + s * u)).normalized()};
}

void ContourPush::push(const std::vector<Crossing>& crossing, double step, double separation, Positions& x) {
    step_ = step;
    separation_ = separation;
    std::fill(pushed_.begin(), pushed_.end(), false);
    plan_.assign(crossing.size(), {});
    for (const Contour& contour : trace_contours(triangle_, topology_, crossing)) plan(crossing, contour, x);
    for (std::size_t c = 0; c < crossing.size(); ++c) {
        switch (plan_[c].way) {
            case Way::first_end:
                push_out(crossing[c], 0, x);
                break;
            case Way::second_end:
                push_out(crossing[c], 1, x);
                break;
            case Way::swap:
                swap(crossing[c], plan_[c], x);
                break;
            case Way::done:
                break;
            case Way::shorten:
                shorten(crossing[c], x);
                break;
        }
    }
}

void ContourPush::plan(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x) {
    std::vector<int> edges;
    for (const int c : contour.crossing) edges.push_back(crossing[c].edge);
    pieces_.cut(edges, contour.loop_vertex);
    bool border = false, told = !contour.loop_vertex.empty();
    for (const int c : contour.crossing) {
        const int e = crossing[c].edge;
        const bool first = pieces_.cut_off(topology_.edge(e, 0)), second = pieces_.cut_off(topology_.edge(e, 1));
        if (first != second) plan_[c].way = first ? Way::first_end : Way::second_end;
        told |= first != second;
        border |= topology_.edge_triangle(e, 1) < 0;
    }
    if (border && !told)
        plan_shorter_way(crossing, contour, x);
    else
        plan_swaps(crossing, contour, x);
}

/// Crossings of one edge with two triangles that share an edge.
void ContourPush::plan_swaps(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x) {
    for (std::size_t k = 0; k < contour.crossing.size(); ++k) {
        const int c = contour.crossing[k];
        if (plan_[c].way != Way::shorten) continue;
        for (std::size_t m = k + 1; m < contour.crossing.size(); ++m) {
            const int other = contour.crossing[m];
            if (crossing[other].edge != crossing[c].edge) break;
            for (int corner = 0; corner < 3; ++corner) {
                const int e = topology_.triangle_edge(crossing[c].triangle, corner);
                if (topology_.edge_triangle(e, 0) != crossing[other].triangle &&
                    topology_.edge_triangle(e, 1) != crossing[other].triangle)
                    continue;
                plan_[c] = swap_with(crossing[c].edge, e, x);
                plan_[other].way = Way::done;
            }
        }
    }
}

/// Compares the two ways to part the sheets of a contour: the first above the second, or below.
void ContourPush::plan_shorter_way(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x) {
    std::vector<int> if_above;
    double depth_above = 0.0, depth_below = 0.0;
    for (std::size_t k = 0; k < contour.crossing.size(); ++k) {
        const Crossing& at = crossing[contour.crossing[k]];
        const Passage passage = simulate::passage(triangle_, topology_, at, x);
        const bool turned = edge_normal(triangle_, topology_, at.edge, x).dot(passage.normal) < 0.0;
        const bool upwards = !contour.of_second[k] || turned;
        const int lower = passage.height[0] < passage.height[1] ? 0 : 1;
        if_above.push_back(upwards ? lower : 1 - lower);
        depth_above += std::abs(passage.height[if_above.back()]);
        depth_below += std::abs(passage.height[1 - if_above.back()]);
    }
    for (std::size_t k = 0; k < contour.crossing.size(); ++k) {
        const int end = depth_below < depth_above ? 1 - if_above[k] : if_above[k];
        plan_[contour.crossing[k]].way = end == 0 ? Way::first_end : Way::second_end;
    }
}

void ContourPush::push_out(const Crossing& crossing, int inner, Positions& x) {
    const Passage passage = simulate::passage(triangle_, topology_, crossing, x);
    const double in = passage.height[inner], out = passage.height[1 - inner];
    const double side = out > 0.0 || (out == 0.0 && in < 0.0) ? 1.0 : -1.0;
    const double depth = separation_ - side * in;
    if (depth <= 0.0) return;
    Weights weights{{topology_.edge(crossing.edge, inner), 1.0}};
    for (int corner = 0; corner < 3; ++corner)
        weights.emplace_back(triangle_(crossing.triangle, corner), -passage.point_weight[corner]);
    move_apart(weights, side * std::min(depth, step_) * passage.normal, x);
}

/// Moves the edge past the other one, in the direction that led to it when the pass began.
void ContourPush::swap(const Crossing& crossing, const Plan& plan, Positions& x) {
    const int edge = crossing.edge;
    const Weights weights{{topology_.edge(edge, 0), 1.0 - plan.along},
                          {topology_.edge(edge, 1), plan.along},
                          {topology_.edge(plan.other_edge, 0), -1.0 + plan.along_other},
                          {topology_.edge(plan.other_edge, 1), -plan.along_other}};
    Vector3d ahead = Vector3d::Zero();
    for (const auto& [vertex, weight] : weights) ahead += weight * x.row(vertex).transpose();
    const double way = separation_ - plan.direction.dot(ahead);
    if (way > 0.0) move_apart(weights, std::min(way, step_) * plan.direction, x);
}

void ContourPush::shorten(const Crossing& crossing, Positions& x) {
    const Passage passage = simulate::passage(triangle_, topology_, crossing, x);
    const Vector3d gradient = contour_gradient(triangle_, topology_, crossing, passage.normal, x);
    Weights weights{{topology_.edge(crossing.edge, 0), 1.0 - passage.along},
                    {topology_.edge(crossing.edge, 1), passage.along}};
    for (int corner = 0; corner < 3; ++corner)
        weights.emplace_back(triangle_(crossing.triangle, corner), -passage.point_weight[corner]);
    move_apart(weights, 0.5 * step_ / std::sqrt(gradient.squaredNorm() + 0.1) * gradient, x);
}

/// Moves vertices until their weighted sum has changed `by`.
void ContourPush::move_apart(const Weights& weights, const Vector3d& by, Positions& x) {
    double mobility = 0.0;
    for (const auto& [vertex, weight] : weights)
        if (free_[vertex]) mobility += weight * weight;
    if (mobility < 1e-3) return;
    for (const auto& [vertex, weight] : weights) {
        if (!free_[vertex]) continue;
        x.row(vertex) += weight / mobility * by.transpose();
        pushed_[vertex] = true;
    }
}

}  // namespace toile::simulate
