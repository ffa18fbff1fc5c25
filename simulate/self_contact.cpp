#include "simulate/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/membrane.h"
#include "simulate/certificate.h"

namespace toile::simulate {
namespace {

/// Room around what is searched for, so that a search serves several small steps [m]: at most this, and less on fine
/// meshes, where it would hold too many pairs.
constexpr double widest_margin = 0.004;
/// A motion is first shortened until no more than this many boxes overlap for each edge of the mesh.
/// Two features that together move by less than this share of their distance are not looked at.
constexpr double room_share = 0.8;
constexpr long most_overlaps = 60;
/// Friction is smoothed below this speed [m/s], and never below this length [m].
constexpr double sticking_speed = 0.002, shortest_slip = 1e-5;
/// The barrier goes on as a straight line below this share of the thickness, where it is some tens of p₀: Newton's
/// matrix stays well conditioned however near two features are.
constexpr double straight_share = 0.05;
/// Rounds in which `limit` shortens zones before it shortens everything alike.
constexpr int most_rounds = 30;
/// A round that holds back holds back by at least this factor, so that few are needed.
constexpr double least_progress = 0.8;
/// Searches in which `limit` shortens zones before it shortens everything alike.
constexpr int most_searches = 8;

double largest_norm(const Positions& rows) {
    return rows.rows() > 0 ? std::sqrt(rows.rowwise().squaredNorm().maxCoeff()) : 0.0;
}

}  // namespace

SelfContact::SelfContact(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options,
                         double pressure)
    : options_(options),
      pressure_(pressure),
      vertex_area_(Eigen::VectorXd::Zero(mesh.vertex_count())),
      edge_area_(Eigen::VectorXd::Zero(topology.edge.rows())),
      rest_length_(edge_rest_lengths(mesh, topology)),
      thickness_(feature_thickness(mesh, topology, rest_length_, options.thickness)),
      candidates_(mesh.triangle, topology.edge) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const double area = membrane_stencil(mesh, f).area;
        for (int c = 0; c < 3; ++c) {
            vertex_area_[mesh.triangle(f, c)] += area / 3.0;
            edge_area_[topology.triangle_edge(f, c)] += area / 3.0;
        }
    }
    candidates_.set_reach(thickness_.vertex, thickness_.triangle, thickness_.edge);
    if (rest_length_.size() > 0) margin_ = std::min(widest_margin, 0.25 * rest_length_.mean());
}

void SelfContact::begin_step(const Positions& x, double time_step) {
    before_ = x;
    smoothing_ = std::max(shortest_slip, sticking_speed * time_step);
}

void SelfContact::collect(const Positions& x) {
    pairs_.clear();
    const double unknown = 0.0;
    for (const VertexTrianglePair& pair : found_.vertex_triangle)
        pairs_.push_back({pair.point, false, 0.5 * vertex_area_[pair.vertex],
                          std::min(thickness_.vertex[pair.vertex], thickness_.triangle[pair.triangle]), unknown});
    for (const EdgeEdgePair& pair : found_.edge_edge)
        pairs_.push_back({pair.point, true, 0.25 * (edge_area_[pair.first] + edge_area_[pair.second]),
                          std::min(thickness_.edge[pair.first], thickness_.edge[pair.second]), unknown});
    fade_.assign(pairs_.size(), 1.0);
    for (size_t k = 0; k < pairs_.size(); ++k) {
        Pair& pair = pairs_[k];
        pair.distance = proximity(pair, x).distance();
        if (!pair.edges) continue;
        const EdgeEdgePair& edges = found_.edge_edge[k - found_.vertex_triangle.size()];
        fade_[k] = mollifier_threshold(rest_length_[edges.first], rest_length_[edges.second]);
    }
}

bool SelfContact::covers(const Positions& x, double reach) const {
    if (found_at_.rows() != x.rows()) return false;
    Positions off = x - found_at_;
    if (found_along_.rows() > 0) {
        const double along = off.cwiseProduct(found_along_).sum() / found_along_.squaredNorm();
        off -= std::clamp(along, 0.0, 1.0) * found_along_;
    }
    return 2.0 * (largest_norm(off) + reach) <= margin_;
}

double SelfContact::search(const Positions& x, const Positions& motion) {
    double share = 1.0;
    ++searches_;
    found_at_ = x;
    if (4.0 * largest_norm(motion) <= margin_) {
        candidates_.find(x, margin_, found_);
        found_along_.resize(0, 3);
    } else {
        // With room around the whole way: where it ends nothing need be looked for.
        share = candidates_.find_bounded(x, motion, margin_, most_overlaps * (rest_length_.size() + 100), found_);
        found_along_ = share * motion;
    }
    collect(x);
    return share;
}

void SelfContact::look_around(const Positions& x) {
    if (!covers(x, 0.0)) search(x, Positions::Zero(x.rows(), 3));
}

bool SelfContact::is_known_safe(const Positions& x, const Positions& motion) const {
    return covers(x, largest_norm(motion)) && safe_share(pairs_, x, motion) >= 1.0;
}

double SelfContact::limit(const Positions& x, Positions& motion) {
    if (covers(x, largest_norm(motion))) return limit_among(pairs_, x, motion);
    const Positions whole = motion;
    double left = 1.0;
    // Pairs that move alike are not looked for; once one of the two is shortened they may meet, so look again.
    for (int round = 0; round < most_searches; ++round) {
        const double searched = search(x, motion);
        motion *= searched;
        const double share = searched * limit_among(pairs_, x, motion);
        left *= share;
        if (share >= 1.0) {
            linearise(x);
            return left;
        }
    }
    motion = whole;
    return limit_alike(x, motion);
}

double SelfContact::limit_alike(const Positions& x, Positions& motion) {
    double searched = 1.0;
    if (!covers(x, largest_norm(motion))) {
        searched = search(x, motion);
        motion *= searched;
        linearise(x);
    }
    const double share = safe_share(pairs_, x, motion);
    motion *= share;
    return searched * share;
}

Proximity SelfContact::proximity(const Pair& pair, const Positions& x) const {
    const FourPoints points = gather(x, pair.point);
    return pair.edges ? edge_edge_proximity(points) : vertex_triangle_proximity(points);
}

double SelfContact::fade(size_t index, const Positions& x) const {
    const Pair& pair = pairs_[index];
    return pair.edges ? parallel_mollifier(gather(x, pair.point), fade_[index]).value : 1.0;
}

double SelfContact::pair_safe_share(const Pair& pair, const Positions& x, const Positions& motion,
                                    const Eigen::VectorXd& length) const {
    const auto& p = pair.point;
    const double first = pair.edges ? std::max(length[p[0]], length[p[1]]) : length[p[0]];
    const double other = std::max({pair.edges ? 0.0 : length[p[1]], length[p[2]], length[p[3]]});
    if (first + other < room_share * pair.distance) return 1.0;
    const FourPoints points = gather(x, pair.point), moves = gather(motion, pair.point);
    const SafeMotionOptions options{.largest_remaining = 0.1 * pair.thickness};
    return pair.edges ? edge_edge_safe_share(points, moves, options)
                      : vertex_triangle_safe_share(points, moves, options);
}

double SelfContact::limit_among(const std::vector<Pair>& pairs, const Positions& x, Positions& motion) const {
    const Positions whole = motion;
    Eigen::VectorXd share = Eigen::VectorXd::Ones(x.rows());
    Eigen::VectorXd length = motion.rowwise().norm();
    std::vector<int> shortened_in(static_cast<size_t>(x.rows()), 0);  // the last round, from 1; 0: never
    double smallest = 1.0;
    for (int round = 1; round <= most_rounds; ++round) {
        bool any = false;
        for (const Pair& pair : pairs) {
            if (round > 1) {
                bool changed = false;
                for (int v : pair.point) changed |= shortened_in[v] >= round - 1;
                if (!changed) continue;
            }
            const double safe = pair_safe_share(pair, x, motion, length);
            if (safe >= 1.0) continue;
            any = true;
            // Those that still go furthest are held back first: what is short already need not become shorter. The
            // pair is looked at again in the next round.
            double furthest = 0.0;
            for (int v : pair.point) furthest = std::max(furthest, share[v]);
            for (int v : pair.point) {
                const double held = std::min(share[v], std::min(safe, least_progress) * furthest);
                if (held == share[v]) continue;
                share[v] = held;
                motion.row(v) = held * whole.row(v);
                length[v] = motion.row(v).norm();
                shortened_in[v] = round;
                smallest = std::min(smallest, held);
            }
        }
        if (!any) return smallest;
    }
    smallest = safe_share(pairs, x, whole);
    motion = smallest * whole;
    return smallest;
}

double SelfContact::safe_share(const std::vector<Pair>& pairs, const Positions& x, const Positions& motion) const {
    const Eigen::VectorXd length = motion.rowwise().norm();
    double smallest = 1.0;
    for (const Pair& pair : pairs) smallest = std::min(smallest, pair_safe_share(pair, x, motion, length));
    return smallest;
}

SelfContact::Pressure SelfContact::pressure_at(const Pair& pair, double distance) const {
    const double bent = std::max(distance / pair.thickness, straight_share), depth = 1.0 - bent;
    const double further = bent - distance / pair.thickness;
    const double force = depth * depth / bent, slope = (1.0 - bent * bent) / (bent * bent);
    const double energy = -std::log(bent) - 2.0 * depth + 0.5 * (1.0 - bent * bent);
    const double scale = pair.area * pressure_;
    return {scale * pair.thickness * (energy + further * (force + 0.5 * slope * further)),
            scale * (force + slope * further), scale / pair.thickness * slope};
}

void SelfContact::linearise(const Positions& x) {
    linearised_at_ = x;
    touches_.clear();
    touching_.clear();
    nearly_touching_.clear();
    for (size_t k = 0; k < pairs_.size(); ++k) {
        Pair& pair = pairs_[k];
        const Proximity near = proximity(pair, x);
        pair.distance = near.distance();
        if (pair.distance < 2.0 * pair.thickness) nearly_touching_.push_back(pair.point);
        const double depth = pair.thickness - pair.distance;
        if (!(depth > 0.0) || !(pair.distance > 0.0)) continue;
        Touch touch{pair.point,          near.weight, near.difference / pair.distance, 0.0, 0.0, {}, 0.0,
                    static_cast<int>(k), 1.0};
        touch.fade = fade(k, x);
        const Pressure pressure = pressure_at(pair, pair.distance);
        touch.force = touch.fade * pressure.force;
        touch.slope = touch.fade * pressure.slope;
        Eigen::Vector3d slip = Eigen::Vector3d::Zero();
        for (int i = 0; i < 4; ++i)
            slip += near.weight[i] * (x.row(pair.point[i]) - before_.row(pair.point[i])).transpose();
        touch.slip = slip - slip.dot(touch.normal) * touch.normal;
        touch.largest_friction = options_.friction * touch.force;
        touches_.push_back(touch);
        touching_.push_back(pair.point);
    }
}

double SelfContact::friction_energy(const Touch& touch, const Positions& x) const {
    Eigen::Vector3d slip = Eigen::Vector3d::Zero();
    for (int i = 0; i < 4; ++i)
        slip += touch.weight[i] * (x.row(touch.point[i]) - before_.row(touch.point[i])).transpose();
    slip -= slip.dot(touch.normal) * touch.normal;
    const double length = slip.norm();
    return touch.largest_friction *
           (length < smoothing_ ? 0.5 * length * length / smoothing_ : length - 0.5 * smoothing_);
}

double SelfContact::energy(const Positions& x) const {
    const Eigen::VectorXd moved = (x - linearised_at_).rowwise().norm();
    double energy = 0.0;
    size_t next = 0;
    for (size_t k = 0; k < pairs_.size(); ++k) {
        const Pair& pair = pairs_[k];
        double fade = 1.0;
        const bool touched = next < touches_.size() && touches_[next].pair == static_cast<int>(k);
        if (touched) fade = touches_[next++].fade;
        // A distance changes by no more than its features move: most pairs need not be looked up.
        const auto& p = pair.point;
        const double first = pair.edges ? std::max(moved[p[0]], moved[p[1]]) : moved[p[0]];
        const double other = std::max({pair.edges ? 0.0 : moved[p[1]], moved[p[2]], moved[p[3]]});
        if (pair.distance - first - other >= pair.thickness) continue;
        if (!touched && pair.edges) fade = this->fade(k, linearised_at_);
        const double distance = proximity(pair, x).distance();
        if (distance < pair.thickness) energy += fade * pressure_at(pair, distance).energy;
    }
    for (const Touch& touch : touches_) energy += friction_energy(touch, x);
    return energy;
}

void SelfContact::add_gradient(Positions& gradient) const {
    for (const Touch& touch : touches_) {
        const double length = touch.slip.norm();
        const Eigen::Vector3d force =
            -touch.force * touch.normal + touch.largest_friction / std::max(length, smoothing_) * touch.slip;
        for (int i = 0; i < 4; ++i) gradient.row(touch.point[i]) += touch.weight[i] * force.transpose();
    }
}

void SelfContact::add_hessian(BlockValues& hessian) const {
    const BlockSymbolic& symbolic = hessian.symbolic();
    for (const Touch& touch : touches_) {
        const double tangential = touch.largest_friction / std::max(touch.slip.norm(), smoothing_);
        const Eigen::Matrix3d block = (touch.slope - tangential) * touch.normal * touch.normal.transpose() +
                                      tangential * Eigen::Matrix3d::Identity();
        for (int i = 0; i < 4; ++i) {
            if (touch.weight[i] == 0.0) continue;
            hessian.add(touch.point[i], touch.weight[i] * touch.weight[i] * block);
            for (int j = 0; j < i; ++j)
                if (touch.weight[j] != 0.0)
                    hessian.add(symbolic.slot(touch.point[i], touch.point[j]),
                                touch.weight[i] * touch.weight[j] * block);
        }
    }
}

}  // namespace toile::simulate
