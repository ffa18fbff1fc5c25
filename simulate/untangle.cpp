#include "simulate/untangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "cloth/error.h"
#include "simulate/contours.h"
#include "simulate/crossings.h"

namespace toile::simulate {

namespace {

using Eigen::Vector3d;

void check(bool fine, const char* field, double value, const char* bound) {
    if (!fine)
        throw Error("untangle." + std::string(field) + " is " + std::to_string(value) + ", but must be " + bound);
}

/// Where an edge passes through a triangle's plane, and how.
struct Passage {
    Vector3d normal;                   // of the triangle, unit
    Vector3d point_weight;             // barycentric, of the passage clamped to the triangle
    double along = 0.5;                // of the edge, from its first end
    double first = 0.0, second = 0.0;  // heights of the edge's ends over the plane [m]
    bool defined = false;              // false for a triangle without area
};

class Untangler {
  public:
    Untangler(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
              const UntangleOptions& options, Positions& x);
    UntangleReport run();

  private:
    void push(const std::vector<Crossing>& crossing);
    void push_out(const Crossing& crossing, int inner);
    void shorten_contour(const Crossing& crossing);
    void fair();
    void hold_lengths();
    Passage passage(const Crossing& crossing) const;
    void move_apart(const Crossing& crossing, const Vector3d& edge_weight, const Vector3d& triangle_weight,
                    const Vector3d& by);
    void move(int vertex, const Vector3d& by);
    Vector3d at(int vertex) const { return x_.row(vertex).transpose(); }
    std::vector<int> surroundings(int rings) const;

    const Triangles& triangle_;
    const Topology& topology_;
    const UntangleOptions& options_;
    Positions& x_;
    const Positions start_;
    VertexRing ring_;
    std::vector<int> component_;
    std::vector<bool> free_;
    std::vector<double> length_;  // of each edge at the start
    double step_;                 // [m]
    std::vector<bool> pushed_;    // in this round
};

Untangler::Untangler(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                     const UntangleOptions& options, Positions& x)
    : triangle_(triangle),
      topology_(topology),
      options_(options),
      x_(x),
      start_(x),
      ring_(topology, static_cast<int>(x.rows())),
      component_(connected_components(triangle, static_cast<int>(x.rows()))),
      free_(x.rows(), true),
      pushed_(x.rows(), false) {
    for (const int v : pinned) {
        if (v < 0 || v >= x.rows()) throw Error("untangle: pinned vertex " + std::to_string(v) + " does not exist");
        free_[v] = false;
    }
    double sum = 0.0;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        length_.push_back((at(topology.edge(e, 0)) - at(topology.edge(e, 1))).norm());
        sum += length_.back();
    }
    step_ = options.largest_step * sum / std::max<double>(1.0, static_cast<double>(length_.size()));
}

void Untangler::move(int vertex, const Vector3d& by) {
    if (!free_[vertex]) return;
    x_.row(vertex) += by.transpose();
    pushed_[vertex] = true;
}

Passage Untangler::passage(const Crossing& crossing) const {
    Passage passage;
    const Vector3d p = at(triangle_(crossing.triangle, 0)), q = at(triangle_(crossing.triangle, 1)),
                   r = at(triangle_(crossing.triangle, 2));
    const Vector3d area = (q - p).cross(r - p);
    const double twice_area = area.norm();
    if (!(twice_area > 1e-300)) return passage;
    passage.defined = true;
    passage.normal = area / twice_area;
    const Vector3d a = at(topology_.edge(crossing.edge, 0)), b = at(topology_.edge(crossing.edge, 1));
    passage.first = passage.normal.dot(a - p);
    passage.second = passage.normal.dot(b - p);
    const double drop = passage.first - passage.second;
    if (std::abs(drop) > 1e-300) passage.along = std::clamp(passage.first / drop, 0.0, 1.0);
    const Vector3d point = (1.0 - passage.along) * a + passage.along * b;
    passage.point_weight << passage.normal.dot((q - point).cross(r - point)),
        passage.normal.dot((r - point).cross(p - point)), passage.normal.dot((p - point).cross(q - point));
    passage.point_weight = (passage.point_weight / twice_area).cwiseMax(0.0);
    passage.point_weight /= passage.point_weight.sum();
    return passage;
}

/// Moves edge and triangle against each other until the weighted points are `by` further apart.
void Untangler::move_apart(const Crossing& crossing, const Vector3d& edge_weight, const Vector3d& triangle_weight,
                           const Vector3d& by) {
    double total = 0.0;
    for (int end = 0; end < 2; ++end)
        if (free_[topology_.edge(crossing.edge, end)]) total += edge_weight[end] * edge_weight[end];
    for (int corner = 0; corner < 3; ++corner)
        if (free_[triangle_(crossing.triangle, corner)]) total += triangle_weight[corner] * triangle_weight[corner];
    if (total < 1e-3) return;
    for (int end = 0; end < 2; ++end) move(topology_.edge(crossing.edge, end), edge_weight[end] / total * by);
    for (int corner = 0; corner < 3; ++corner)
        move(triangle_(crossing.triangle, corner), -triangle_weight[corner] / total * by);
}

void Untangler::push_out(const Crossing& crossing, int inner) {
    const Passage passage = this->passage(crossing);
    if (!passage.defined) return;
    const double in = inner == 0 ? passage.first : passage.second, out = inner == 0 ? passage.second : passage.first;
    const double side = out > 0.0 || (out == 0.0 && in < 0.0) ? 1.0 : -1.0;
    const double depth = options_.separation - side * in;
    if (depth <= 0.0) return;
    Vector3d edge_weight = Vector3d::Zero();
    edge_weight[inner] = 1.0;
    move_apart(crossing, edge_weight, passage.point_weight, side * std::min(depth, step_) * passage.normal);
}

void Untangler::shorten_contour(const Crossing& crossing) {
    const Passage passage = this->passage(crossing);
    if (!passage.defined) return;
    const Vector3d a = at(topology_.edge(crossing.edge, 0)), b = at(topology_.edge(crossing.edge, 1));
    const double length = (b - a).norm();
    if (!(length > 0.0)) return;
    const Vector3d along = (b - a) / length;
    const double steepness = along.dot(passage.normal);
    Vector3d gain = Vector3d::Zero();
    for (int side = 0; side < 2; ++side) {
        const int f = topology_.edge_triangle(crossing.edge, side);
        if (f < 0) continue;
        const int corner = topology_.triangle_edge(f, 0) == crossing.edge   ? 0
                           : topology_.triangle_edge(f, 1) == crossing.edge ? 1
                                                                            : 2;
        const Vector3d inward = (at(triangle_(f, corner)) - a) - along * along.dot(at(triangle_(f, corner)) - a);
        Vector3d contour = passage.normal.cross(along.cross(inward));
        const double norm = contour.norm();
        if (!(norm > 1e-300)) continue;
        contour *= (contour.dot(inward) > 0.0 ? 1.0 : -1.0) / norm;
        const double bounded = std::copysign(std::max(std::abs(steepness), 0.1), steepness);
        gain += contour - along.dot(contour) / bounded * passage.normal;
    }
    const Vector3d by = 0.5 * step_ / std::sqrt(gain.squaredNorm() + 0.1) * gain;
    move_apart(crossing, {1.0 - passage.along, passage.along, 0.0}, passage.point_weight, by);
}

void Untangler::push(const std::vector<Crossing>& crossing) {
    const std::vector<CrossingSide> side = contour_sides(topology_, ring_, component_, crossing);
    std::fill(pushed_.begin(), pushed_.end(), false);
    for (std::size_t c = 0; c < crossing.size(); ++c) {
        if (side[c].inner >= 0)
            push_out(crossing[c], side[c].inner);
        else
            shorten_contour(crossing[c]);
    }
}

/// The vertices pushed in this round and those around them, in order.
std::vector<int> Untangler::surroundings(int rings) const {
    std::vector<bool> near = pushed_;
    for (int ring = 0; ring < rings; ++ring) {
        const std::vector<bool> before = near;
        for (int e = 0; e < topology_.edge.rows(); ++e) {
            const int a = topology_.edge(e, 0), b = topology_.edge(e, 1);
            if (before[a] || before[b]) near[a] = near[b] = true;
        }
    }
    std::vector<int> list;
    for (int v = 0; v < static_cast<int>(near.size()); ++v)
        if (near[v]) list.push_back(v);
    return list;
}

/// Draws the vertices around the pushed ones along.
void Untangler::fair() {
    const std::vector<int> near = surroundings(3);
    std::vector<Vector3d> target(near.size());
    for (std::size_t k = 0; k < near.size(); ++k) {
        const int v = near[k];
        Vector3d sum = Vector3d::Zero();
        for (int s = ring_.start[v]; s < ring_.start[v + 1]; ++s) {
            const int w = ring_.spoke[s].neighbour;
            sum += (x_.row(w) - start_.row(w)).transpose();
        }
        const int count = ring_.start[v + 1] - ring_.start[v];
        target[k] = start_.row(v).transpose() + sum / std::max(1, count);
    }
    for (std::size_t k = 0; k < near.size(); ++k)
        if (free_[near[k]] && !pushed_[near[k]]) x_.row(near[k]) += 0.5 * (target[k].transpose() - x_.row(near[k]));
}

void Untangler::hold_lengths() {
    for (int e = 0; e < topology_.edge.rows(); ++e) {
        const int a = topology_.edge(e, 0), b = topology_.edge(e, 1);
        const int count = static_cast<int>(free_[a]) + static_cast<int>(free_[b]);
        if (count == 0) continue;
        const Vector3d apart = at(b) - at(a);
        const double length = apart.norm();
        const double kept = std::clamp(length, (1.0 - options_.length_change) * length_[e],
                                       (1.0 + options_.length_change) * length_[e]);
        if (kept == length || !(length > 0.0)) continue;
        const Vector3d by = (length - kept) / (count * length) * apart;
        if (free_[a]) x_.row(a) += by.transpose();
        if (free_[b]) x_.row(b) -= by.transpose();
    }
}

UntangleReport Untangler::run() {
    UntangleReport report;
    std::vector<Crossing> crossing = find_crossings(triangle_, topology_, x_);
    report.crossings_before = report.crossings_after = static_cast<int>(crossing.size());
    if (crossing.empty()) return report;
    Positions best = x_;
    while (!crossing.empty() && report.iterations < options_.max_iterations) {
        push(crossing);
        fair();
        for (int sweep = 0; sweep < 4; ++sweep) hold_lengths();
        ++report.iterations;
        crossing = find_crossings(triangle_, topology_, x_);
        if (static_cast<int>(crossing.size()) < report.crossings_after) {
            report.crossings_after = static_cast<int>(crossing.size());
            best = x_;
        }
    }
    x_ = best;
    report.status = report.crossings_after == 0 ? UntangleStatus::untangled : UntangleStatus::tangled;
    report.largest_move = (x_ - start_).rowwise().norm().maxCoeff();
    return report;
}

}  // namespace

void UntangleOptions::validate() const {
    check(max_iterations >= 1, "max_iterations", max_iterations, "at least 1");
    check(separation >= 0.0 && std::isfinite(separation), "separation", separation, "a length of at least 0");
    check(largest_step > 0.0 && largest_step <= 1.0, "largest_step", largest_step, "in (0, 1]");
    check(length_change > 0.0 && length_change < 1.0, "length_change", length_change, "in (0, 1)");
}

UntangleReport untangle(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                        const UntangleOptions& options, Positions& x) {
    options.validate();
    return Untangler(triangle, topology, pinned, options, x).run();
}

}  // namespace toile::simulate
