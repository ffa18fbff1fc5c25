#include "simulate/drape_run.h"

#include <algorithm>
#include <cmath>

#include "simulate/certificate.h"
#include "simulate/self_intersection.h"
#include "simulate/stopwatch.h"
#include "skin/surface_query.h"

namespace toile::simulate {
namespace {

/// Range of the pseudo time step while the cloth settles [s]; the upper end is statics.
constexpr double shortest_time_step = 1e-3, longest_time_step = 1e3;

}  // namespace

DrapeRun::DrapeRun(const DrapeModel& shared) : shared_(shared), scene_(shared.scene) {
    if (scene_.body) {
        body_ = std::make_unique<CollisionBody>(*scene_.body, scene_.skinning, shared.surface, scene_.level_set,
                                                scene_.contact->thickness);
        add_contact(*body_);
    }
    if (scene_.table) add_contact(*solids_.emplace_back(std::make_unique<Table>(*scene_.table)));
    if (scene_.sphere) add_contact(*solids_.emplace_back(std::make_unique<Sphere>(*scene_.sphere)));
    std::vector<Contact*> contacts;
    for (auto& contact : contacts_) contacts.push_back(contact.get());
    step_ = std::make_unique<ImplicitStep>(scene_.mesh, shared.elasticity, shared.symbolic, scene_.pinned, contacts,
                                           scene_.solver.damping);
}

void DrapeRun::start(const Positions& x, const skin::Pose& neutral) {
    x_ = carried_ = inertial_ = x;
    velocity_ = Positions::Zero(x.rows(), 3);
    if (!body_) return;
    body_->move_to(neutral, true, report_);
    const skin::SurfaceQuery query(scene_.body->triangle, body_->position());
    for (int v = 0; v < x.rows(); ++v) {
        const skin::SurfaceQuery::Nearest nearest = query.nearest(x.row(v).transpose());
        int corner = 0;
        nearest.barycentric.maxCoeff(&corner);
        contacts_.front()->set_piece(v, scene_.body->triangle(nearest.triangle, corner));
    }
}

void DrapeRun::add_contact(const Obstacle& obstacle) {
    contacts_.push_back(std::make_unique<Contact>(*scene_.contact, shared_.pressure, shared_.points, obstacle));
}

void DrapeRun::begin_step() {
    const Stopwatch watch(report_.contact_seconds);
    for (auto& contact : contacts_) contact->begin_step(x_);
}

void DrapeRun::end_step() {
    const Stopwatch watch(report_.contact_seconds);
    for (auto& contact : contacts_) contact->end_step(x_);
}

double DrapeRun::relative_residual() {
    const Stopwatch watch(report_.contact_seconds);
    return step_->static_residual(x_) / shared_.weight;
}

void DrapeRun::carry_with_body() {
    carried_ = x_;
    for (int v = 0; v < x_.rows(); ++v)
        carried_.row(v) = body_->carry(x_.row(v).transpose(), contacts_.front()->piece(v)).transpose();
    for (int v : scene_.pinned) carried_.row(v) = x_.row(v);
}

void DrapeRun::follow(const skin::Pose& from, const skin::Pose& to) {
    const double turn = skin::largest_joint_rotation(from, to);
    const int steps = static_cast<int>(std::ceil(turn / scene_.schedule.joint_step));
    const double h = scene_.solver.time_step;
    begin_step();
    for (int k = 1; k <= steps; ++k) {
        ++report_.path_steps;
        body_->move_to(skin::interpolate(from, to, static_cast<double>(k) / steps), k == steps, report_);
        carry_with_body();
        x_ = carried_;
        inertial_ = carried_ + h * velocity_;
        begin_step();
        const ImplicitStep::Target target{&carried_, &inertial_, h};
        for (int iteration = 0; iteration < scene_.schedule.path_iterations; ++iteration) {
            const ImplicitStep::Iteration done = step_->iterate(target, x_, report_);
            if (done.largest_move < scene_.schedule.path_tolerance) break;
        }
        velocity_ = (x_ - carried_) / h;
        end_step();
    }
}

void DrapeRun::settle() {
    // Pseudo-transient continuation: implicit Euler without memory of velocity, whose time step grows while Newton's
    // steps are taken in full, up to statics.
    double h = scene_.solver.time_step;
    double target_residual = scene_.solver.residual_tolerance;
    begin_step();
    while (report_.newton_iterations < scene_.solver.max_iterations) {
        const double residual = relative_residual();
        if (!std::isfinite(residual)) return;
        if (residual <= target_residual) {
            if (measure_speed() <= scene_.solver.speed_tolerance) return;
            target_residual *= 0.3;
        }
        const Positions start = x_;
        const ImplicitStep::Target target{&start, &start, h};
        const ImplicitStep::Iteration done = step_->iterate(target, x_, report_);
        end_step();
        if (done.halvings == 0) h = std::min(2.0 * h, longest_time_step);
        if (done.halvings > 1) h = std::max(0.5 * h, shortest_time_step);
    }
}

double DrapeRun::measure_speed() {
    const double h = scene_.solver.time_step;
    const Positions start = x_;
    Positions next = x_;
    const ImplicitStep::Target target{&start, &start, h};
    DrapeReport unreported;
    step_->iterate(target, next, unreported);
    return std::sqrt((next - start).rowwise().squaredNorm().maxCoeff()) / h;
}

double DrapeRun::penetration() const {
    Eigen::VectorXd distance(x_.rows());
    for (int v = 0; v < x_.rows(); ++v)
        distance[v] = body_->distance(x_.row(v).transpose(), contacts_.front()->piece(v));
    return body_penetration(scene_.body->triangle, body_->position(), x_, distance);
}

DrapeStatus DrapeRun::judge(const Certificate& certificate) const {
    if (!x_.allFinite()) return DrapeStatus::not_finite;
    if (!(certificate.residual_force <= scene_.gate.residual_force)) return DrapeStatus::not_at_rest;
    if (!(certificate.max_speed <= scene_.solver.speed_tolerance)) return DrapeStatus::not_at_rest;
    if (!(certificate.body_penetration <= scene_.gate.body_penetration)) return DrapeStatus::penetrates_body;
    if (!(certificate.max_stretch <= scene_.gate.max_stretch)) return DrapeStatus::overstretched;
    return DrapeStatus::accepted;
}

DrapeResult DrapeRun::finish() {
    DrapeResult result;
    Certificate& certificate = result.certificate;
    certificate.residual_force = relative_residual();
    {
        const Stopwatch watch(report_.certificate_seconds);
        if (x_.allFinite()) {
            certificate.max_speed = measure_speed();
            if (body_) certificate.body_penetration = penetration();
            certificate.self_intersections = count_self_intersections(scene_.mesh.triangle, x_);
        }
        const StretchRange range = stretch_range(shared_.topology, shared_.rest_length, x_);
        certificate.max_stretch = range.largest;
        certificate.min_stretch = range.smallest;
    }
    result.status = judge(certificate);
    result.position = x_;
    result.report = report_;
    return result;
}

}  // namespace toile::simulate
