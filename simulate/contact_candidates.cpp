#include "simulate/contact_candidates.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>
#include <limits>

#include "cloth/error.h"

namespace toile::simulate {
namespace {

using Eigen::RowVector3d;

// Rounded outwards: four times what the two roundings to float can take away.
Box vertex_box(const RowVector3d& low, const RowVector3d& high, double margin) {
    constexpr double rounding = 4.0 * std::numeric_limits<float>::epsilon();
    constexpr double least = std::numeric_limits<float>::min();
    Box box = Box::empty();
    if (!(low.cwiseAbs().sum() + high.cwiseAbs().sum() + margin < 1e37)) return box;
    box.low[3] = box.high[3] = 0.0f;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = static_cast<float>(low[k] - margin - rounding * (std::abs(low[k]) + margin) - least);
        box.high[k] = static_cast<float>(high[k] + margin + rounding * (std::abs(high[k]) + margin) + least);
    }
    return box;
}

bool is_finite(const Positions& x, Eigen::Index v) {
    return x.row(v).cwiseAbs().sum() < std::numeric_limits<double>::infinity();
}

double quantile(std::vector<double>& value, double share) {
    const auto nth = value.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(value.size() - 1));
    std::nth_element(value.begin(), nth, value.end());
    return *nth;
}

// Where most vertices are: so that a few that went astray, however far, cost the others no digits.
struct Bulk {
    RowVector3d middle = RowVector3d::Zero();
    double reach = 0.0;
};
Bulk bulk_of(const Positions& x) {
    const Eigen::Index stride = 1 + x.rows() / 1000;
    std::vector<Eigen::Index> sample;
    for (Eigen::Index v = 0; v < x.rows(); v += stride)
        if (is_finite(x, v)) sample.push_back(v);
    Bulk bulk;
    if (sample.empty()) return bulk;
    std::vector<double> value(sample.size());
    for (int k = 0; k < 3; ++k) {
        std::transform(sample.begin(), sample.end(), value.begin(), [&](Eigen::Index v) { return x(v, k); });
        bulk.middle[k] = quantile(value, 0.5);
    }
    std::transform(sample.begin(), sample.end(), value.begin(),
                   [&](Eigen::Index v) { return (x.row(v) - bulk.middle).cwiseAbs().maxCoeff(); });
    bulk.reach = quantile(value, 0.9);
    return bulk;
}

// Motion common to all vertices brings no two nearer.
RowVector3d mean_motion(const Positions& motion) {
    RowVector3d sum = RowVector3d::Zero();
    int finite = 0;
    for (Eigen::Index v = 0; v < motion.rows(); ++v) {
        if (!is_finite(motion, v)) continue;
        sum += motion.row(v);
        ++finite;
    }
    return sum / std::max(finite, 1);
}

std::uint64_t key(int first, int second) {
    return static_cast<std::uint64_t>(first) << 32 | static_cast<std::uint64_t>(second);
}

void sort_keys(std::vector<std::uint64_t>& keys) {
    boost::sort::spreadsort::integer_sort(keys.begin(), keys.end());
}

struct Near {
    const Positions& x;
    double radius;

    bool vertex_triangle(const std::array<int, 4>& point) const {
        return vertex_triangle_proximity(gather(x, point)).squared_distance <= radius * radius;
    }
    bool edge_edge(const std::array<int, 4>& point) const {
        return edge_edge_proximity(gather(x, point)).squared_distance <= radius * radius;
    }
};

struct NearWhileMoving {
    const Positions& x;
    const Positions& motion;
    double radius;

    template <typename Proximity, typename Separation>
    bool may_meet(const std::array<int, 4>& point, Proximity proximity, Separation separation) const {
        FourPoints now = gather(x, point);
        const auto nearest = proximity(now);
        if (nearest.squared_distance <= radius * radius) return true;
        const FourPoints moved = gather(motion, point);
        const double start = separation(nearest.difference, now);
        // The first vertex' motion taken from all: what is common must not cost digits.
        for (int i = 0; i < 4; ++i) now[i] += moved[i] - moved[0];
        const double apart = std::min(start, separation(nearest.difference, now));
        return !(apart > radius * (1.0 + 1e-9) * nearest.distance());
    }
    bool vertex_triangle(const std::array<int, 4>& point) const {
        return may_meet(point, vertex_triangle_proximity, vertex_triangle_separation);
    }
    bool edge_edge(const std::array<int, 4>& point) const {
        return may_meet(point, edge_edge_proximity, edge_edge_separation);
    }
};

}  // namespace

ContactCandidates::ContactCandidates(const Triangles& triangle, const Edges& edge) : triangle_(triangle), edge_(edge) {
    vertex_count_ = triangle.size() > 0 ? triangle.maxCoeff() + 1 : 0;
    if (triangle.size() > 0 && triangle.minCoeff() < 0) throw Error("a triangle of the contact search has no vertex");
    if (edge.size() > 0 && (edge.minCoeff() < 0 || edge.maxCoeff() >= vertex_count_))
        throw Error("an edge of the contact search is none of its triangles'");
}

void ContactCandidates::check(const Positions& x, double radius) const {
    if (x.rows() != vertex_count_)
        throw Error("contact search: " + std::to_string(x.rows()) + " positions for " + std::to_string(vertex_count_) +
                    " vertices");
    if (!(radius >= 0.0 && radius < std::numeric_limits<double>::infinity()))
        throw Error("contact search: the radius must be finite and not negative");
}

void ContactCandidates::make_boxes(const Positions& x, const Positions* motion, double radius) {
    const Bulk bulk = bulk_of(x);
    const RowVector3d common = motion ? mean_motion(*motion) : RowVector3d::Zero().eval();
    const double margin = 0.5 * radius;
    const float reach = static_cast<float>(std::min(bulk.reach, 1e37));
    vertex_box_.resize(vertex_count_);
    for (int v = 0; v < vertex_count_; ++v) {
        const RowVector3d start = x.row(v) - bulk.middle;
        const RowVector3d end = motion ? (start + motion->row(v) - common).eval() : start;
        vertex_box_[v] = vertex_box(start.cwiseMin(end), start.cwiseMax(end), margin);
    }
    vertex_tree_.build(vertex_box_, reach);
    box_.resize(triangle_.rows());
    for (Eigen::Index f = 0; f < triangle_.rows(); ++f)
        box_[f] =
            around(around(vertex_box_[triangle_(f, 0)], vertex_box_[triangle_(f, 1)]), vertex_box_[triangle_(f, 2)]);
    triangle_tree_.build(box_, reach);
    box_.resize(edge_.rows());
    for (Eigen::Index e = 0; e < edge_.rows(); ++e)
        box_[e] = around(vertex_box_[edge_(e, 0)], vertex_box_[edge_(e, 1)]);
    edge_tree_.build(box_, reach);
}

template <typename Keep>
void ContactCandidates::find_vertex_triangle(const Keep& keep, std::vector<VertexTrianglePair>& pairs) {
    const auto points = [&](int vertex, int triangle) -> std::array<int, 4> {
        return {vertex, triangle_(triangle, 0), triangle_(triangle, 1), triangle_(triangle, 2)};
    };
    found_.clear();
    vertex_tree_.each_overlap(triangle_tree_, [&](int vertex, int triangle) {
        const std::array<int, 4> p = points(vertex, triangle);
        if (p[0] == p[1] || p[0] == p[2] || p[0] == p[3] || !keep.vertex_triangle(p)) return;
        found_.push_back(key(vertex, triangle));
    });
    sort_keys(found_);
    pairs.clear();
    for (const std::uint64_t k : found_) {
        const int vertex = static_cast<int>(k >> 32), triangle = static_cast<int>(k & 0xffffffffu);
        pairs.push_back({vertex, triangle, points(vertex, triangle)});
    }
}

template <typename Keep>
void ContactCandidates::find_edge_edge(const Keep& keep, std::vector<EdgeEdgePair>& pairs) {
    const auto points = [&](int first, int second) -> std::array<int, 4> {
        return {edge_(first, 0), edge_(first, 1), edge_(second, 0), edge_(second, 1)};
    };
    found_.clear();
    edge_tree_.each_overlap([&](int one, int other) {
        const int first = std::min(one, other), second = std::max(one, other);
        const std::array<int, 4> p = points(first, second);
        if (p[0] == p[2] || p[0] == p[3] || p[1] == p[2] || p[1] == p[3] || !keep.edge_edge(p)) return;
        found_.push_back(key(first, second));
    });
    sort_keys(found_);
    pairs.clear();
    for (const std::uint64_t k : found_) {
        const int first = static_cast<int>(k >> 32), second = static_cast<int>(k & 0xffffffffu);
        pairs.push_back({first, second, points(first, second)});
    }
}

void ContactCandidates::find(const Positions& x, double radius, CandidatePairs& pairs) {
    check(x, radius);
    make_boxes(x, nullptr, radius);
    const Near keep{x, radius};
    find_vertex_triangle(keep, pairs.vertex_triangle);
    find_edge_edge(keep, pairs.edge_edge);
}

void ContactCandidates::find(const Positions& x, const Positions& motion, double radius, CandidatePairs& pairs) {
    check(x, radius);
    check(motion, radius);
    make_boxes(x, &motion, radius);
    const NearWhileMoving keep{x, motion, radius};
    find_vertex_triangle(keep, pairs.vertex_triangle);
    find_edge_edge(keep, pairs.edge_edge);
}

}  // namespace toile::simulate
