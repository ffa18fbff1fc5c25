#include "simulate/contact.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/membrane.h"

namespace toile::simulate {
namespace {

/// A sticking point is held by a spring this much softer than contact is where cloth touches.
constexpr double stick_softness = 0.1;
/// ... and softer still where contact is light, so that it gives by this much before it slides [m]: less is stiffer
/// than Newton's steps are small.
constexpr double longest_stick = 3e-4;
/// The normal force may waver by this factor before the spring follows it.
constexpr double spring_tolerance = 4.0;

/// The positive semidefinite part of -force ∇²d.
Eigen::Matrix3d hollow_stiffness(const Eigen::Matrix3d& curvature, double force) {
    if (curvature.isZero(0.0)) return Eigen::Matrix3d::Zero();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(curvature);
    const Eigen::Vector3d hollow = (-force * eigen.eigenvalues()).cwiseMax(0.0);
    return eigen.eigenvectors() * hollow.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

std::vector<ContactPoint> contact_points(const ClothMesh& mesh, const Topology& topology,
                                         const BlockSymbolic& symbolic) {
    std::vector<ContactPoint> points(static_cast<size_t>(mesh.vertex_count() + topology.edge.rows()));
    for (int v = 0; v < mesh.vertex_count(); ++v) points[v] = {v, -1, -1, 0.0};
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const int a = topology.edge(e, 0), b = topology.edge(e, 1);
        points[mesh.vertex_count() + e] = {a, b, symbolic.slot(a, b), 0.0};
    }
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const double share = membrane_stencil(mesh, f).area / 6.0;
        for (int corner = 0; corner < 3; ++corner) {
            points[mesh.triangle(f, corner)].area += share;
            points[mesh.vertex_count() + topology.triangle_edge(f, corner)].area += share;
        }
    }
    return points;
}

Contact::Contact(const ContactOptions& options, double pressure, const std::vector<ContactPoint>& points,
                 const Obstacle& obstacle)
    : options_(options),
      pressure_(pressure),
      stick_stiffness_(stick_softness * pressure / options.thickness),
      points_(points),
      obstacle_(obstacle),
      state_(points.size()) {}

void Contact::stiffen(double factor) {
    pressure_ *= factor;
    stick_stiffness_ *= factor;
}

Eigen::Vector3d Contact::position(const Positions& x, const ContactPoint& point) const {
    if (point.second < 0) return x.row(point.first).transpose();
    return 0.5 * (x.row(point.first) + x.row(point.second)).transpose();
}

double Contact::pressure_at(double depth) const {
    const double share = depth / options_.thickness;
    return pressure_ * share * share;
}

void Contact::scatter(const ContactPoint& point, const Eigen::Vector3d& gradient, Positions& total) const {
    if (point.second < 0) {
        total.row(point.first) += gradient.transpose();
    } else {
        total.row(point.first) += 0.5 * gradient.transpose();
        total.row(point.second) += 0.5 * gradient.transpose();
    }
}

void Contact::begin_step(const Positions& x) {
    for (size_t k = 0; k < points_.size(); ++k) {
        State& state = state_[k];
        const Eigen::Vector3d p = position(x, points_[k]);
        int last = state.piece;
        if (last < 0 && points_[k].second >= 0) last = state_[points_[k].first].piece;
        const int piece = obstacle_.piece_near(p, last);
        if (state.anchored) {
            state.anchor_world = obstacle_.to_world(state.anchor, state.piece);
            if (piece != state.piece) state.anchor = obstacle_.to_local(state.anchor_world, piece);
        }
        state.piece = piece;
        state.distance = -std::numeric_limits<double>::infinity();  // to be looked up again
    }
}

bool Contact::is_clear(const State& state, const Eigen::Vector3d& p) const {
    // A distance changes by no more than its point moves: most points need not be looked up.
    const double clear = state.distance - options_.thickness;
    return clear > 0.0 && (p - state.position).squaredNorm() < clear * clear;
}

void Contact::linearise(const Positions& x) {
    for (size_t k = 0; k < points_.size(); ++k) {
        State& state = state_[k];
        const Eigen::Vector3d p = position(x, points_[k]);
        if (is_clear(state, p)) {
            state.normal_force = 0.0;
            state.anchored = false;
            continue;
        }
        state.position = p;
        const Obstacle::Contact contact = obstacle_.sample(state.position, state.piece);
        state.distance = contact.distance;
        state.gradient = contact.gradient;
        const double depth = options_.thickness - contact.distance, length = contact.gradient.norm();
        state.normal_force = depth > 0.0 ? points_[k].area * pressure_at(depth) * length : 0.0;
        if (!(state.normal_force > 0.0)) {
            state.normal_force = 0.0;
            state.anchored = false;
            continue;
        }
        state.normal = contact.gradient / length;
        state.hollow =
            hollow_stiffness(obstacle_.curvature(state.position, state.piece), points_[k].area * pressure_at(depth));
        if (!state.anchored) {
            state.anchored = true;
            state.spring = stick_spring(points_[k], state.normal_force, 0.0);
            state.anchor_world = state.position;
            state.anchor = obstacle_.to_local(state.anchor_world, state.piece);
        }
    }
}

Eigen::Vector3d Contact::slip_of(const State& state, const Eigen::Vector3d& p) const {
    const Eigen::Vector3d slip = p - state.anchor_world;
    return slip - slip.dot(state.normal) * state.normal;
}

double Contact::largest_friction(const State& state) const {
    return options_.friction * state.normal_force;
}

double Contact::stick_spring(const ContactPoint& point, double normal_force, double spring) const {
    // The spring is left alone while the normal force only wavers: following it would couple the two, and the drape
    // would creep instead of coming to rest.
    const double wanted = std::min(stick_stiffness_ * point.area, options_.friction * normal_force / longest_stick);
    return wanted > spring_tolerance * spring || spring_tolerance * wanted < spring ? wanted : spring;
}

void Contact::end_step(const Positions& x) {
    for (size_t k = 0; k < points_.size(); ++k) {
        State& state = state_[k];
        if (!state.anchored) continue;
        const Eigen::Vector3d p = position(x, points_[k]), slip = slip_of(state, p);
        const double length = slip.norm(), most = largest_friction(state);
        const double force = std::min(state.spring * length, most);
        state.spring = stick_spring(points_[k], state.normal_force, state.spring);
        // The normal part is dropped, so the anchor stays beside its point as the surface turns.
        state.anchor_world = p - (length > 0.0 && state.spring > 0.0 ? force / (state.spring * length) : 0.0) * slip;
        state.anchor = obstacle_.to_local(state.anchor_world, state.piece);
    }
}

double Contact::energy(const Positions& x) const {
    double energy = 0.0;
    for (size_t k = 0; k < points_.size(); ++k) {
        const State& state = state_[k];
        const Eigen::Vector3d p = position(x, points_[k]);
        if (!is_clear(state, p)) {
            const double depth = options_.thickness - obstacle_.distance(p, state.piece);
            if (depth > 0.0) energy += points_[k].area * pressure_at(depth) * depth / 3.0;
        }
        energy += friction_energy(state, p);
    }
    return energy;
}

double Contact::friction_energy(const State& state, const Eigen::Vector3d& p) const {
    const double most = largest_friction(state);
    if (!(most > 0.0)) return 0.0;
    const double length = slip_of(state, p).norm(), spring = state.spring;
    return spring * length < most ? 0.5 * spring * length * length : most * (length - 0.5 * most / spring);
}

double Contact::friction_energy(const Positions& x) const {
    double energy = 0.0;
    for (size_t k = 0; k < points_.size(); ++k) energy += friction_energy(state_[k], position(x, points_[k]));
    return energy;
}

void Contact::add_gradient(Positions& gradient) const {
    for (size_t k = 0; k < points_.size(); ++k) {
        const State& state = state_[k];
        const double depth = options_.thickness - state.distance;
        if (!(depth > 0.0)) continue;
        Eigen::Vector3d local = -points_[k].area * pressure_at(depth) * state.gradient;
        const double most = largest_friction(state);
        if (most > 0.0) {
            const Eigen::Vector3d slip = slip_of(state, state.position);
            local += std::min(state.spring, most / slip.norm()) * slip;
        }
        scatter(points_[k], local, gradient);
    }
}

Eigen::Matrix3d Contact::hessian_block(const ContactPoint& point, const State& state) const {
    const double slope =
        2.0 * pressure_ * (options_.thickness - state.distance) / (options_.thickness * options_.thickness);
    Eigen::Matrix3d block = point.area * slope * state.gradient * state.gradient.transpose() + state.hollow;
    const double most = largest_friction(state);
    if (most > 0.0) {
        const Eigen::Matrix3d tangent = Eigen::Matrix3d::Identity() - state.normal * state.normal.transpose();
        const Eigen::Vector3d slip = slip_of(state, state.position);
        const double length = slip.norm();
        if (state.spring * length < most) {
            block += state.spring * tangent;
        } else {
            block += most / length * (tangent - slip * slip.transpose() / (length * length));
        }
    }
    return block;
}

void Contact::add_hessian(BlockValues& hessian) const {
    for (size_t k = 0; k < points_.size(); ++k) {
        const ContactPoint& point = points_[k];
        if (!(state_[k].distance < options_.thickness)) continue;
        const Eigen::Matrix3d block = hessian_block(point, state_[k]);
        if (point.second < 0) {
            hessian.add(point.first, block);
        } else {
            hessian.add(point.first, 0.25 * block);
            hessian.add(point.second, 0.25 * block);
            hessian.add(point.slot, 0.25 * block);
        }
    }
}

}  // namespace toile::simulate
