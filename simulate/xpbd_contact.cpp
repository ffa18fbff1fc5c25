#include "simulate/xpbd_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile::simulate {
namespace {

/// A touching point's plane is renewed once it has moved by this share of the thickness from where it was looked up.
constexpr double plane_reach = 0.25;
/// Between sweeps points may be further from where the step began than it lets them go in the end.
constexpr double move_reserve = 2.0;

Eigen::Vector3d position_of(const ContactPoint& point, const Positions& x) {
    if (point.second < 0) return x.row(point.first).transpose();
    return 0.5 * (x.row(point.first) + x.row(point.second)).transpose();
}

double inverse_mass_of(const ContactPoint& point, const Eigen::VectorXd& inverse_mass) {
    if (point.second < 0) return inverse_mass[point.first];
    return 0.25 * (inverse_mass[point.first] + inverse_mass[point.second]);
}

void add_force(const ContactPoint& point, const Eigen::Vector3d& force, Positions& total) {
    if (point.second < 0) {
        total.row(point.first) += force.transpose();
    } else {
        total.row(point.first) += 0.5 * force.transpose();
        total.row(point.second) += 0.5 * force.transpose();
    }
}

void push(const XpbdMobility& mobility, const ContactPoint& point, const Eigen::Vector3d& force, Positions& x) {
    const double q = mobility.squared_time;
    if (point.second < 0) {
        x.row(point.first) += q * mobility.inverse_mass[point.first] * force.transpose();
    } else {
        x.row(point.first) += 0.5 * q * mobility.inverse_mass[point.first] * force.transpose();
        x.row(point.second) += 0.5 * q * mobility.inverse_mass[point.second] * force.transpose();
    }
}

void look_up(const Obstacle& obstacle, const Eigen::Vector3d& p, XpbdTouch& touch) {
    const Obstacle::Contact sample = obstacle.sample(p, touch.piece);
    touch.sampled_at = p;
    touch.distance = sample.distance;
    touch.gradient = sample.gradient;
    touch.sampled = true;
}

/// Whether a point may be touched although its last look-up says it is clear.
bool may_touch(const XpbdTouch& touch, const Eigen::Vector3d& p, double thickness) {
    const double clear = touch.distance - thickness;
    return !(clear > 0.0) || (p - touch.sampled_at).squaredNorm() >= clear * clear;
}

Eigen::Vector3d tangential(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
    return v - v.dot(normal) * normal;
}

/// Coulomb: no longer than `most`.
Eigen::Vector3d clipped(const Eigen::Vector3d& force, double most) {
    const double length = force.norm();
    return length > most ? Eigen::Vector3d(most / length * force) : force;
}

}  // namespace

std::vector<XpbdTouch> XpbdContact::no_touches() const {
    return std::vector<XpbdTouch>(contact_->points().size());
}

void XpbdContact::keep_anchors(std::vector<XpbdTouch>& touches) const {
    for (XpbdTouch& touch : touches)
        if (touch.anchored) touch.anchor_local = contact_->obstacle().to_local(touch.anchor, touch.piece);
}

void XpbdContact::tie(bool solid_moved, std::vector<XpbdTouch>& touches) const {
    for (size_t k = 0; k < touches.size(); ++k) {
        XpbdTouch& touch = touches[k];
        if (touch.anchored) touch.anchor = contact_->obstacle().to_world(touch.anchor_local, touch.piece);
        touch.piece = contact_->piece(static_cast<int>(k));
        if (solid_moved || touch.distance < contact_->options().thickness) touch.sampled = false;
    }
}

std::vector<int> XpbdContact::begin(const Positions& x, double largest_move, std::vector<XpbdTouch>& touches) const {
    const double thickness = contact_->options().thickness, reach = plane_reach * thickness;
    const double away = largest_move > 0.0 ? move_reserve * largest_move : std::numeric_limits<double>::infinity();
    std::vector<int> near;
    for (size_t k = 0; k < touches.size(); ++k) {
        XpbdTouch& touch = touches[k];
        const Eigen::Vector3d p = position_of(contact_->points()[k], x);
        const double squared_move = (p - touch.sampled_at).squaredNorm(), clear = touch.distance - thickness - away;
        if (touch.sampled && touch.pressing == 0.0 && clear > 0.0 && squared_move < clear * clear) continue;
        near.push_back(static_cast<int>(k));
        const bool is_near = !touch.sampled || may_touch(touch, p, thickness);
        if (is_near && (!touch.sampled || squared_move > reach * reach)) look_up(contact_->obstacle(), p, touch);
        if (touch.anchored) touch.friction = tangential(touch.friction, touch.gradient.normalized());
    }
    return near;
}

void XpbdContact::add_forces(const std::vector<int>& near, const std::vector<XpbdTouch>& touches,
                             Positions& total) const {
    for (int k : near)
        if (touches[k].pressing > 0.0)
            add_force(contact_->points()[k], touches[k].pressing * touches[k].gradient + touches[k].friction, total);
}

void XpbdContact::sweep(const XpbdMobility& mobility, const std::vector<int>& near, std::vector<XpbdTouch>& touches,
                        Positions& x) const {
    const ContactOptions& options = contact_->options();
    for (int k : near) {
        XpbdTouch& touch = touches[k];
        const ContactPoint& point = contact_->points()[k];
        const Eigen::Vector3d p = position_of(point, x);
        if (touch.pressing == 0.0) {
            if (!may_touch(touch, p, options.thickness)) continue;
            look_up(contact_->obstacle(), p, touch);
        }
        const double length = touch.gradient.norm(),
                     w = mobility.squared_time * inverse_mass_of(point, mobility.inverse_mass);
        const double yield = w * length * length;  // of the distance to the multiplier
        const double depth = options.thickness - touch.distance - touch.gradient.dot(p - touch.sampled_at);
        // With u the depth that is left: multiplier k u², u + yield k u² = the depth without any.
        const double stiffness = point.area * contact_->pressure() / (options.thickness * options.thickness);
        const double free_depth = depth + yield * touch.pressing;
        const double left =
            free_depth > 0.0 ? 2.0 * free_depth / (1.0 + std::sqrt(1.0 + 4.0 * yield * stiffness * free_depth)) : 0.0;
        const double pressing = length > 0.0 ? stiffness * left * left : 0.0;
        Eigen::Vector3d change = (pressing - touch.pressing) * touch.gradient;
        touch.pressing = pressing;
        Eigen::Vector3d friction = Eigen::Vector3d::Zero();
        if (pressing > 0.0 && options.friction > 0.0) {
            const Eigen::Vector3d normal = touch.gradient / length;
            if (!touch.anchored) {
                touch.anchored = true;
                touch.anchor = p;
                touch.spring = contact_->stick_spring(point, pressing * length, 0.0);
            }
            const Eigen::Vector3d wanted = -touch.spring * tangential(p - touch.anchor, normal);
            friction = clipped(touch.friction + (wanted - touch.friction) / (1.0 + w * touch.spring),
                               options.friction * pressing * length);
        } else {
            touch.anchored = false;
        }
        change += friction - touch.friction;
        touch.friction = friction;
        push(mobility, point, change, x);
    }
}

void XpbdContact::end(const std::vector<int>& near, const Positions& x, std::vector<XpbdTouch>& touches) const {
    const ContactOptions& options = contact_->options();
    for (int k : near) {
        XpbdTouch& touch = touches[k];
        if (!touch.anchored) continue;
        const ContactPoint& point = contact_->points()[k];
        const double length = touch.gradient.norm(), normal_force = touch.pressing * length;
        const Eigen::Vector3d p = position_of(point, x), slip = tangential(p - touch.anchor, touch.gradient / length);
        const double slipped = slip.norm(), force = std::min(touch.spring * slipped, options.friction * normal_force);
        touch.spring = contact_->stick_spring(point, normal_force, touch.spring);
        const double share = slipped > 0.0 && touch.spring > 0.0 ? force / (touch.spring * slipped) : 0.0;
        touch.anchor = p - share * slip;
    }
}

void XpbdContact::add_static_forces(const Positions& x, const std::vector<XpbdTouch>& touches, Positions& total) const {
    const ContactOptions& options = contact_->options();
    for (size_t k = 0; k < touches.size(); ++k) {
        const XpbdTouch& touch = touches[k];
        const ContactPoint& point = contact_->points()[k];
        const Eigen::Vector3d p = position_of(point, x);
        if (touch.sampled && !may_touch(touch, p, options.thickness)) continue;
        const Obstacle::Contact sample = contact_->obstacle().sample(p, touch.piece);
        const double share = (options.thickness - sample.distance) / options.thickness, length = sample.gradient.norm();
        if (!(share > 0.0) || !(length > 0.0)) continue;
        const double pressing = point.area * contact_->pressure() * share * share;
        Eigen::Vector3d force = pressing * sample.gradient;
        if (touch.anchored)
            force += clipped(-touch.spring * tangential(p - touch.anchor, sample.gradient / length),
                             options.friction * pressing * length);
        add_force(point, force, total);
    }
}

}  // namespace toile::simulate
