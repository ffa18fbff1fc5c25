#include "simulate/xpbd_self_contact.h"

#include <algorithm>
#include <cmath>

namespace toile::simulate {
namespace {

/// Pairs are listed that are within this of their thickness [m], and felt in a step that begins within the other: the
/// list serves until the cloth has moved by half of the difference.
constexpr double listed_within = 0.001, activation = 0.0004;
/// Friction is smoothed below this speed [m/s], and never below this length [m], as in `SelfContact`.
constexpr double sticking_speed = 0.002, shortest_slip = 1e-5;
constexpr int most_newton_steps = 30;

double inverse_mass_of(const XpbdMobility& mobility, const std::array<int, 4>& point,
                       const std::array<double, 4>& weight) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += weight[i] * weight[i] * mobility.inverse_mass[point[i]];
    return sum;
}

}  // namespace

XpbdSelfContact::XpbdSelfContact(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options,
                                 double pressure)
    : contact_(mesh, topology, options, pressure) {}

void XpbdSelfContact::look_around(const Positions& x) {
    contact_.look_around(x);
    if (search_ == contact_.searches() && found_at_.rows() == x.rows()) {
        moved_ = (x - found_at_).rowwise().norm();
        if (2.0 * moved_.maxCoeff() <= listed_within - activation) return;
    }
    search_ = contact_.searches();
    found_at_ = x;
    moved_ = Eigen::VectorXd::Zero(x.rows());
    near_.clear();
    index_.clear();
    found_distance_.clear();
    const auto& pairs = contact_.pairs();
    for (size_t k = 0; k < pairs.size(); ++k) {
        const double distance = contact_.proximity(pairs[k], x).distance();
        if (!(distance < pairs[k].thickness + listed_within)) continue;
        near_.push_back(pairs[k]);
        index_.push_back(k);
        found_distance_.push_back(distance);
    }
}

void XpbdSelfContact::touch(const Positions& x) {
    look_around(x);
    touches_.clear();
    for (size_t k = 0; k < near_.size(); ++k) {
        SelfContact::Pair& pair = near_[k];
        const auto& p = pair.point;
        // A distance changes by no more than its features move.
        const double first = pair.edges ? std::max(moved_[p[0]], moved_[p[1]]) : moved_[p[0]];
        const double other = std::max({pair.edges ? 0.0 : moved_[p[1]], moved_[p[2]], moved_[p[3]]});
        pair.distance = found_distance_[k] - first - other;
        if (pair.distance >= pair.thickness + activation) continue;
        const Proximity near = contact_.proximity(pair, x);
        pair.distance = near.distance();
        if (!(pair.distance < pair.thickness + activation) || !(pair.distance > 0.0)) continue;
        touches_.push_back({p, near.weight, near.difference / pair.distance, pair, contact_.fade(index_[k], x)});
    }
}

void XpbdSelfContact::begin(const XpbdMobility& mobility, double time_step, bool keep_forces, const Positions& start) {
    touch(start);
    smoothing_ = std::max(shortest_slip, sticking_speed * time_step);
    if (!keep_forces) return;
    for (Touch& touch : touches_) {
        if (touch.pair.distance >= touch.pair.thickness) continue;
        const SelfContact::Pressure pressure = contact_.pressure_at(touch.pair, touch.pair.distance);
        const double yield = mobility.squared_time * inverse_mass_of(mobility, touch.point, touch.weight);
        const double stiffness = yield * touch.fade * pressure.slope;
        touch.force = kept_share(stiffness) * touch.fade * pressure.force;
    }
}

void XpbdSelfContact::add_forces(Positions& total) const {
    for (const Touch& touch : touches_)
        for (int i = 0; i < 4; ++i)
            total.row(touch.point[i]) += touch.weight[i] * touch.force * touch.normal.transpose();
}

double XpbdSelfContact::solve(const Touch& touch, double free_distance, double yield, double guess) const {
    // The root u of u − yield p(u) = free_distance, found from below, where Newton's steps never pass it: p is convex.
    const double thickness = touch.pair.thickness;
    if (free_distance >= thickness) return 0.0;
    double distance = free_distance;
    if (guess > free_distance && guess < thickness &&
        guess - yield * touch.fade * contact_.pressure_at(touch.pair, guess).force <= free_distance)
        distance = guess;
    double force = 0.0;
    for (int step = 0; step < most_newton_steps; ++step) {
        const SelfContact::Pressure pressure = contact_.pressure_at(touch.pair, distance);
        force = touch.fade * pressure.force;
        const double lacking = free_distance + yield * force - distance;
        if (!(lacking > 1e-13 * thickness)) break;
        distance = std::min(thickness, distance + lacking / (1.0 + yield * touch.fade * pressure.slope));
    }
    return force;
}

void XpbdSelfContact::sweep(const XpbdMobility& mobility, const Positions& start, Positions& x) {
    const double friction = contact_.options().friction;
    for (Touch& touch : touches_) {
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();
        for (int i = 0; i < 4; ++i)
            moved += touch.weight[i] * (x.row(touch.point[i]) - start.row(touch.point[i])).transpose();
        const double along = touch.normal.dot(moved), distance = touch.pair.distance + along;
        if (touch.force == 0.0 && distance >= touch.pair.thickness) continue;
        const double yield = mobility.squared_time * inverse_mass_of(mobility, touch.point, touch.weight);
        const double force = solve(touch, distance - yield * touch.force, yield, touch.pair.distance);
        Eigen::Vector3d change = (force - touch.force) * touch.normal;
        touch.force = force;
        if (friction > 0.0) {
            // f = −c slip, with the slip that f itself leaves.
            const double most = friction * force, c = most / smoothing_;
            Eigen::Vector3d wanted = c / (1.0 + c * yield) * (yield * touch.friction - (moved - along * touch.normal));
            const double length = wanted.norm();
            if (length > most) wanted *= most / length;
            change += wanted - touch.friction;
            touch.friction = wanted;
        }
        for (int i = 0; i < 4; ++i)
            x.row(touch.point[i]) +=
                (mobility.squared_time * mobility.inverse_mass[touch.point[i]] * touch.weight[i]) * change.transpose();
    }
}

void XpbdSelfContact::limit(const Positions& start, Positions& x) {
    Positions motion = x - start;
    const double longest = std::sqrt(motion.rowwise().squaredNorm().maxCoeff());
    if (!std::isfinite(longest)) return;
    look_around(start);
    double left = 1.0;
    if (2.0 * (moved_.maxCoeff() + longest) <= listed_within) {
        left = contact_.limit_among(near_, start, motion);
    } else {
        contact_.begin_step(start, 1.0);
        contact_.linearise(start);
        left = contact_.limit(start, motion);
    }
    if (left < 1.0) x = start + motion;
}

void XpbdSelfContact::add_stiffness(const Positions& x, Eigen::VectorXd& stiffness) {
    touch(x);
    for (const Touch& touch : touches_) {
        if (touch.pair.distance >= touch.pair.thickness) continue;
        const double slope = touch.fade * contact_.pressure_at(touch.pair, touch.pair.distance).slope;
        double sum = 0.0;
        for (double weight : touch.weight) sum += std::abs(weight);
        for (int i = 0; i < 4; ++i) stiffness[touch.point[i]] += slope * sum * std::abs(touch.weight[i]);
    }
}

void XpbdSelfContact::add_static_forces(const Positions& x, Positions& total) {
    touch(x);
    for (Touch& touch : touches_) {
        if (touch.pair.distance >= touch.pair.thickness) continue;
        touch.force = touch.fade * contact_.pressure_at(touch.pair, touch.pair.distance).force;
    }
    add_forces(total);
}

}  // namespace toile::simulate
