#include "simulate/solid_touch.h"

#include <algorithm>

namespace toile::simulate {
namespace {

/// Speed at which a vertex below the thickness is taken back to it [m/s].
constexpr double recovery_speed = 0.5;
/// A vertex so little above the thickness, over the thickness, is held from coming nearer: otherwise the cloth would
/// pull in what gravity lifts off, in turns.
constexpr double hold = 0.01;
/// Reach of a look-up's plane, along it and below the thickness, over the thickness.
constexpr double plane_reach = 0.1;

Eigen::Vector3d tangential(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
    return v - v.dot(normal) * normal;
}

/// Coulomb's law lagged by a substep: the share of the slip that friction may take, so that what it takes is at most
/// its coefficient times the normal impulse. A new contact, of which nothing is known yet, goes by its prediction.
double grip_of(const SolidTouches::Touch& touch, double friction, double new_normal, double new_slip) {
    const bool pressed = touch.touched && touch.normal_impulse > 0.0, known = pressed && touch.grip > 0.0;
    const double most = friction * (pressed ? touch.normal_impulse : new_normal);
    const double wanted = known ? touch.tangential_impulse / touch.grip : new_slip;
    return wanted > most ? most / wanted : friction > 0.0 ? 1.0 : 0.0;
}

}  // namespace

SolidTouches::SolidTouches(const Contact& contact, int vertex_count)
    : contact_(&contact), touch_(static_cast<size_t>(vertex_count)) {}

void SolidTouches::forget_distances() {
    for (Touch& touch : touch_) touch.known = false;
}

void SolidTouches::tie(const Positions& x) {
    for (int v = 0; v < x.rows(); ++v)
        touch_[v].local = contact_->obstacle().to_local(x.row(v).transpose(), contact_->piece(v));
}

void SolidTouches::take_surface_velocities(const Positions& carried, double time) {
    for (int v = 0; v < carried.rows(); ++v) {
        Touch& touch = touch_[v];
        const Eigen::Vector3d moved = contact_->obstacle().to_world(touch.local, contact_->piece(v));
        touch.surface_velocity = (moved - carried.row(v).transpose()) / time;
        touch.ease = 1.0;
    }
}

void SolidTouches::rest_surface() {
    for (Touch& touch : touch_) touch.surface_velocity.setZero();
}

std::optional<Obstacle::Contact> SolidTouches::look(int vertex, const Eigen::Vector3d& x) {
    Touch& touch = touch_[vertex];
    const double near = (1.0 + hold) * contact_->options().thickness;
    const auto found_near = [near](const Obstacle::Contact& found) {
        return found.distance < near && found.gradient.squaredNorm() > 0.0 ? std::optional(found) : std::nullopt;
    };
    if (touch.known) {
        // A distance changes by no more than its point moves: most vertices need not be looked up.
        const double clear = touch.distance - near, moved = (x - touch.looked_up).squaredNorm();
        if (clear > 0.0 && moved < clear * clear) return std::nullopt;
        const double reach = plane_reach * contact_->options().thickness;
        const double plane = touch.distance + touch.gradient.dot(x - touch.looked_up);
        if (clear <= 0.0 && moved < reach * reach && plane > contact_->options().thickness - reach)
            return found_near({plane, touch.gradient});
    }
    const Obstacle::Contact found = contact_->obstacle().sample(x, contact_->piece(vertex));
    touch.known = true;
    touch.looked_up = x;
    touch.distance = found.distance;
    touch.gradient = found.gradient;
    return found_near(found);
}

std::optional<SolidPush> SolidTouches::push(int vertex, const MovingVertex& moving) {
    Touch& touch = touch_[vertex];
    const std::optional<Obstacle::Contact> found = look(vertex, moving.now);
    std::optional<SolidPush> push;
    if (found) push = push_from(*found, moving, touch);
    touch.touched = push.has_value();
    if (!push) touch.ease = 1.0;
    return push;
}

std::optional<SolidPush> SolidTouches::push_from(const Obstacle::Contact& found, const MovingVertex& moving,
                                                 Touch& touch) const {
    const ContactOptions& options = contact_->options();
    const double h = moving.time_step, held = hold * options.thickness;
    const Eigen::Vector3d n = found.gradient.normalized();
    const double depth = options.thickness - found.distance;
    const double start = n.dot(moving.before - moving.now) - depth;  // above the thickness, where the substep began
    if (depth < 0.0 && start > held) return std::nullopt;
    if (touch.touched && n.dot(touch.normal) < 0.0) touch.ease *= 0.5;
    touch.normal = n;
    const double recovered = std::min(0.0, start + touch.ease * recovery_speed * h);
    const double target = start > held ? 0.0 : start > 0.0 ? start : recovered;

    const Eigen::Vector3d along = tangential(touch.surface_velocity, n);
    const Eigen::Vector3d way = moving.now - moving.before - h * along;
    const double impulse = moving.mass / h;  // of a move by a metre
    touch.grip =
        grip_of(touch, options.friction, std::max(0.0, depth + target) * impulse, tangential(way, n).norm() * impulse);
    return SolidPush{n, depth + target, along, touch.grip, start < 0.0};
}

void SolidTouches::weigh(int vertex, double normal_impulse, double tangential_impulse) {
    touch_[vertex].normal_impulse = normal_impulse;
    touch_[vertex].tangential_impulse = tangential_impulse;
}

}  // namespace toile::simulate
