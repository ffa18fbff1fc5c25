#include "simulate/untangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "cloth/error.h"
#include "simulate/contour_push.h"
#include "simulate/crossings.h"
#include "simulate/sheet_gap.h"

namespace toile::simulate {

namespace {

using Eigen::Vector3d;

void check(bool fine, const char* field, double value, const char* bound) {
    if (!fine)
        throw Error("untangle." + std::string(field) + " is " + std::to_string(value) + ", but must be " + bound);
}

/// Rounds without progress before the surface is smoothed; each time again in a wider neighbourhood.
constexpr int patience = 4;

class Untangler {
  public:
    Untangler(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
              const UntangleOptions& options, Positions& x);
    UntangleReport run();

  private:
    void fair();
    void hold_lengths();
    void open_gaps(UntangleReport& report);
    Vector3d at(int vertex) const { return x_.row(vertex).transpose(); }
    std::vector<int> surroundings(std::vector<bool> marked, int rings) const;
    void iron(const std::vector<Crossing>& crossing, int rings);

    const Triangles& triangle_;
    const Topology& topology_;
    const UntangleOptions& options_;
    Positions& x_;
    const Positions start_;
    VertexRing ring_;
    std::vector<bool> free_;
    std::vector<double> length_;  // of each edge, to be kept
    double step_;                 // [m]
    ContourPush push_;
};

Untangler::Untangler(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                     const UntangleOptions& options, Positions& x)
    : triangle_(triangle),
      topology_(topology),
      options_(options),
      x_(x),
      start_(x),
      ring_(topology, static_cast<int>(x.rows())),
      free_(x.rows(), true),
      push_(triangle, topology, ring_, free_) {
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

/// `marked` vertices and those up to `rings` edges around them, in order.
std::vector<int> Untangler::surroundings(std::vector<bool> marked, int rings) const {
    std::vector<int> list;
    for (int v = 0; v < static_cast<int>(marked.size()); ++v)
        if (marked[v]) list.push_back(v);
    for (std::size_t from = 0, to = list.size(); rings > 0; --rings, from = to, to = list.size()) {
        for (std::size_t k = from; k < to; ++k) {
            for (int s = ring_.start[list[k]]; s < ring_.start[list[k] + 1]; ++s) {
                const int other = ring_.spoke[s].neighbour;
                if (marked[other]) continue;
                marked[other] = true;
                list.push_back(other);
            }
        }
    }
    std::sort(list.begin(), list.end());
    return list;
}

/// Smooths the surface itself around what still crosses. Edges there may stay as short as that makes them.
void Untangler::iron(const std::vector<Crossing>& crossing, int rings) {
    std::vector<bool> crossed(x_.rows(), false);
    for (const Crossing& at : crossing) {
        for (int end = 0; end < 2; ++end) crossed[topology_.edge(at.edge, end)] = true;
        for (int corner = 0; corner < 3; ++corner) crossed[triangle_(at.triangle, corner)] = true;
    }
    const std::vector<int> near = surroundings(crossed, rings);
    const Positions before = x_;
    for (const int v : near) {
        const int count = ring_.start[v + 1] - ring_.start[v];
        if (!free_[v] || count == 0) continue;
        Vector3d sum = Vector3d::Zero();
        for (int s = ring_.start[v]; s < ring_.start[v + 1]; ++s)
            sum += before.row(ring_.spoke[s].neighbour).transpose();
        x_.row(v) = 0.5 * before.row(v) + 0.5 / count * sum.transpose();
    }
    std::vector<bool> smoothed(x_.rows(), false);
    for (const int v : near) smoothed[v] = true;
    for (int e = 0; e < topology_.edge.rows(); ++e) {
        const int a = topology_.edge(e, 0), b = topology_.edge(e, 1);
        if (smoothed[a] && smoothed[b]) length_[e] = std::min(length_[e], (at(a) - at(b)).norm());
    }
}

/// Draws the vertices around the pushed ones along.
void Untangler::fair() {
    const std::vector<int> near = surroundings(push_.pushed(), 1);
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
        if (free_[near[k]] && !push_.pushed()[near[k]])
            x_.row(near[k]) += 0.5 * (target[k].transpose() - x_.row(near[k]));
}

void Untangler::hold_lengths() {
    for (int e = 0; e < topology_.edge.rows(); ++e) {
        const int a = topology_.edge(e, 0), b = topology_.edge(e, 1);
        const int count = static_cast<int>(free_[a]) + static_cast<int>(free_[b]);
        if (count == 0) continue;
        const Vector3d apart = at(b) - at(a);
        const double length = apart.norm();
        const double kept =
            std::clamp(length, (1.0 - options_.max_shrink) * length_[e], (1.0 + options_.max_stretch) * length_[e]);
        if (kept == length || !(length > 0.0)) continue;
        const Vector3d by = (length - kept) / (count * length) * apart;
        if (free_[a]) x_.row(a) += by.transpose();
        if (free_[b]) x_.row(b) -= by.transpose();
    }
}

/// Once nothing crosses: gives what has moved its separation, as far as that makes nothing cross.
void Untangler::open_gaps(UntangleReport& report) {
    std::vector<bool> moved(x_.rows());
    for (Eigen::Index v = 0; v < x_.rows(); ++v) moved[v] = x_.row(v) != start_.row(v);
    SheetGap gap(triangle_, topology_.edge, free_);
    report.gap = gap.smallest(moved, options_.separation, x_);
    double share = 1.0;
    while (report.gap < options_.separation && share > 0.05 && report.iterations < options_.max_iterations) {
        const Positions before = x_;
        gap.open(moved, options_.separation * (1.0 + 1e-6), share, x_);
        ++report.iterations;
        const bool crosses = !x_.allFinite() || !find_crossings(triangle_, topology_, x_).empty();
        const double opened = crosses ? 0.0 : gap.smallest(moved, options_.separation, x_);
        if (opened > report.gap) {
            report.gap = opened;
        } else {
            share *= 0.5;
            x_ = before;
        }
    }
}

UntangleReport Untangler::run() {
    UntangleReport report;
    std::vector<Crossing> crossing = find_crossings(triangle_, topology_, x_);
    report.crossings_before = report.crossings_after = static_cast<int>(crossing.size());
    if (crossing.empty()) return report;
    Positions best = x_;
    int best_iteration = 0;
    while (!crossing.empty() && report.iterations < options_.max_iterations) {
        const int idle = report.iterations - best_iteration;
        if (idle > 0 && idle % patience == 0) iron(crossing, std::min(idle / patience, 3));
        push_.push(crossing, step_, options_.separation, x_);
        fair();
        for (int sweep = 0; sweep < 4; ++sweep) hold_lengths();
        ++report.iterations;
        if (!x_.allFinite()) break;  // lengths beyond what squares can hold
        crossing = find_crossings(triangle_, topology_, x_);
        if (static_cast<int>(crossing.size()) < report.crossings_after) {
            report.crossings_after = static_cast<int>(crossing.size());
            best = x_;
            best_iteration = report.iterations;
        }
    }
    x_ = best;
    report.status = report.crossings_after == 0 ? UntangleStatus::untangled : UntangleStatus::tangled;
    if (report.crossings_after == 0) open_gaps(report);
    report.largest_move = (x_ - start_).rowwise().norm().maxCoeff();
    return report;
}

}  // namespace

void UntangleOptions::validate() const {
    check(max_iterations >= 1, "max_iterations", max_iterations, "at least 1");
    check(separation >= 0.0 && std::isfinite(separation), "separation", separation, "a length of at least 0");
    check(largest_step > 0.0 && largest_step <= 1.0, "largest_step", largest_step, "in (0, 1]");
    check(max_stretch > 0.0 && std::isfinite(max_stretch), "max_stretch", max_stretch, "more than 0");
    check(max_shrink > 0.0 && max_shrink < 1.0, "max_shrink", max_shrink, "in (0, 1)");
}

UntangleReport untangle(const Triangles& triangle, const Topology& topology, const std::vector<int>& pinned,
                        const UntangleOptions& options, Positions& x) {
    options.validate();
    return Untangler(triangle, topology, pinned, options, x).run();
}

}  // namespace toile::simulate
