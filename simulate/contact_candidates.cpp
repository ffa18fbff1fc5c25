#include "simulate/contact_candidates.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>
#include <limits>

#include "cloth/error.h"

namespace toile::simulate {
namespace {

using Eigen::RowVector3d;

// To the nearest float: `Box::widen` makes up for it. What is not finite has no box.
Box vertex_box(const RowVector3d& low, const RowVector3d& high) {
    Box box = Box::empty();
    if (!(low.cwiseAbs().sum() + high.cwiseAbs().sum() < 1e37)) return box;
    box.low[3] = box.high[3] = 0.0f;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = static_cast<float>(low[k]);
        box.high[k] = static_cast<float>(high[k]);
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

    bool vertex_triangle(const std::array<int, 4>& point, double radius) const {
        return vertex_triangle_proximity(gather(x, point)).squared_distance <= radius * radius;
    }
    bool edge_edge(const std::array<int, 4>& point, double radius) const {
        return edge_edge_proximity(gather(x, point)).squared_distance <= radius * radius;
    }
};

struct NearWhileMoving {
    const Positions& x;
    const Positions& motion;

    template <typename Proximity, typename Separation>
    bool may_meet(const std::array<int, 4>& point, double radius, Proximity proximity, Separation separation) const {
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
    bool vertex_triangle(const std::array<int, 4>& point, double radius) const {
        return may_meet(point, radius, vertex_triangle_proximity, vertex_triangle_separation);
    }
    bool edge_edge(const std::array<int, 4>& point, double radius) const {
        return may_meet(point, radius, edge_edge_proximity, edge_edge_separation);
    }
};

constexpr long no_bound = std::numeric_limits<long>::max();

}  // namespace

ContactCandidates::ContactCandidates(const Triangles& triangle, const Edges& edge) : triangle_(triangle), edge_(edge) {
    vertex_count_ = triangle.size() > 0 ? triangle.maxCoeff() + 1 : 0;
    if (triangle.size() > 0 && triangle.minCoeff() < 0) throw Error("a triangle of the contact search has no vertex");
    if (edge.size() > 0 && (edge.minCoeff() < 0 || edge.maxCoeff() >= vertex_count_))
        throw Error("an edge of the contact search is none of its triangles'");
    vertex_reach_.setZero(vertex_count_);
    triangle_reach_.setZero(triangle.rows());
    edge_reach_.setZero(edge.rows());
}

void ContactCandidates::set_reach(const Eigen::VectorXd& vertex, const Eigen::VectorXd& triangle,
                                  const Eigen::VectorXd& edge) {
    if (vertex.size() != vertex_reach_.size() || triangle.size() != triangle_reach_.size() ||
        edge.size() != edge_reach_.size())
        throw Error("contact search: a reach is needed for each vertex, triangle and edge");
    for (const Eigen::VectorXd* reach : {&vertex, &triangle, &edge})
        if (!reach->allFinite() || (reach->size() > 0 && reach->minCoeff() < 0.0))
            throw Error("contact search: a reach must be finite and not negative");
    vertex_reach_ = vertex;
    triangle_reach_ = triangle;
    edge_reach_ = edge;
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
    const float reach = static_cast<float>(std::min(bulk.reach, 1e37));
    vertex_box_.resize(vertex_count_);
    for (int v = 0; v < vertex_count_; ++v) {
        const RowVector3d start = x.row(v) - bulk.middle;
        const RowVector3d end = motion ? (start + motion->row(v) - common).eval() : start;
        vertex_box_[v] = vertex_box(start.cwiseMin(end), start.cwiseMax(end));
    }
    // Half of the distance to either side: half the lesser reach twice is at most half of each.
    const auto build = [&](BoxTree& tree, const Eigen::VectorXd& feature_reach, const auto& feature_box) {
        box_.resize(feature_reach.size());
        for (Eigen::Index i = 0; i < feature_reach.size(); ++i) {
            box_[i] = feature_box(i);
            box_[i].widen(static_cast<float>(0.5 * (radius + feature_reach[i])));
        }
        tree.build(box_, reach);
    };
    build(vertex_tree_, vertex_reach_, [&](Eigen::Index v) { return vertex_box_[v]; });
    build(triangle_tree_, triangle_reach_, [&](Eigen::Index f) {
        return around(around(vertex_box_[triangle_(f, 0)], vertex_box_[triangle_(f, 1)]), vertex_box_[triangle_(f, 2)]);
    });
    build(edge_tree_, edge_reach_,
          [&](Eigen::Index e) { return around(vertex_box_[edge_(e, 0)], vertex_box_[edge_(e, 1)]); });
}

template <typename Keep>
bool ContactCandidates::find_vertex_triangle(const Keep& keep, double radius, long most,
                                             std::vector<VertexTrianglePair>& pairs) {
    const auto points = [&](int vertex, int triangle) -> std::array<int, 4> {
        return {vertex, triangle_(triangle, 0), triangle_(triangle, 1), triangle_(triangle, 2)};
    };
    found_.clear();
    const bool complete = vertex_tree_.each_overlap(triangle_tree_, [&](int vertex, int triangle) {
        const std::array<int, 4> p = points(vertex, triangle);
        const double within = radius + std::min(vertex_reach_[vertex], triangle_reach_[triangle]);
        if (p[0] != p[1] && p[0] != p[2] && p[0] != p[3] && keep.vertex_triangle(p, within))
            found_.push_back(key(vertex, triangle));
        return --most >= 0;
    });
    sort_keys(found_);
    pairs.clear();
    for (const std::uint64_t k : found_) {
        const int vertex = static_cast<int>(k >> 32), triangle = static_cast<int>(k & 0xffffffffu);
        pairs.push_back({vertex, triangle, points(vertex, triangle)});
    }
    return complete;
}

template <typename Keep>
bool ContactCandidates::find_edge_edge(const Keep& keep, double radius, long most, std::vector<EdgeEdgePair>& pairs) {
    const auto points = [&](int first, int second) -> std::array<int, 4> {
        return {edge_(first, 0), edge_(first, 1), edge_(second, 0), edge_(second, 1)};
    };
    found_.clear();
    const bool complete = edge_tree_.each_overlap([&](int one, int other) {
        const int first = std::min(one, other), second = std::max(one, other);
        const std::array<int, 4> p = points(first, second);
        const double within = radius + std::min(edge_reach_[first], edge_reach_[second]);
        if (p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3] && keep.edge_edge(p, within))
            found_.push_back(key(first, second));
        return --most >= 0;
    });
    sort_keys(found_);
    pairs.clear();
    for (const std::uint64_t k : found_) {
        const int first = static_cast<int>(k >> 32), second = static_cast<int>(k & 0xffffffffu);
        pairs.push_back({first, second, points(first, second)});
    }
    return complete;
}

void ContactCandidates::find(const Positions& x, double radius, CandidatePairs& pairs) {
    check(x, radius);
    make_boxes(x, nullptr, radius);
    find_vertex_triangle(Near{x}, radius, no_bound, pairs.vertex_triangle);
    find_edge_edge(Near{x}, radius, no_bound, pairs.edge_edge);
}

void ContactCandidates::find(const Positions& x, const Positions& motion, double radius, CandidatePairs& pairs) {
    find_bounded(x, motion, radius, no_bound, pairs);
}

double ContactCandidates::find_bounded(const Positions& x, const Positions& motion, double radius, long most,
                                       CandidatePairs& pairs) {
    check(x, radius);
    check(motion, radius);
    Positions part = motion;
    for (double share = 1.0;; share *= 0.5, part *= 0.5) {
        if (share < least_share) most = no_bound;
        make_boxes(x, &part, radius);
        const NearWhileMoving keep{x, part};
        if (find_edge_edge(keep, radius, most, pairs.edge_edge) &&
            find_vertex_triangle(keep, radius, most, pairs.vertex_triangle))
            return share;
    }
}

}  // namespace toile::simulate
