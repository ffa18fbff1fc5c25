#include "simulate/drape_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulate/certificate.h"
#include "simulate/self_intersection.h"
#include "simulate/stopwatch.h"
#include "skin/surface_query.h"

namespace toile::simulate {
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
    solver_ = make_solver(shared, contacts, report_);
}

void DrapeRun::start(const Positions& x, const skin::Pose& neutral) {
    if (body_) tie_to_body(x, neutral);
    solver_->start(x);
}

void DrapeRun::tie_to_body(const Positions& x, const skin::Pose& neutral) {
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

double DrapeRun::relative_residual() {
    return solver_->residual_force() / shared_.weight;
}

void DrapeRun::carry_with_body() {
    const Positions& x = solver_->position();
    carried_ = x;
    for (int v = 0; v < x.rows(); ++v)
        carried_.row(v) = body_->carry(x.row(v).transpose(), contacts_.front()->piece(v)).transpose();
    for (int v : scene_.pinned) carried_.row(v) = x.row(v);
}

void DrapeRun::follow(const skin::Pose& from, const skin::Pose& to) {
    const double turn = skin::largest_joint_rotation(from, to);
    const int steps = static_cast<int>(std::ceil(turn / scene_.schedule.joint_step));
    for (int k = 1; k <= steps; ++k) {
        ++report_.path_steps;
        body_->move_to(skin::interpolate(from, to, static_cast<double>(k) / steps), k == steps, report_);
        carry_with_body();
        solver_->follow(carried_);
    }
}

void DrapeRun::settle(const EnergyWatch& watch) {
    bool first = true;
    double target_residual = scene_.solver.residual_tolerance;
    while (report_.iterations < scene_.solver.max_iterations) {
        const double residual = relative_residual();
        if (watch) watch(solver_->energy(), std::exchange(first, false));
        if (!std::isfinite(residual)) return;
        if (residual <= target_residual) {
            if (solver_->largest_speed() <= scene_.solver.speed_tolerance) return;
            target_residual *= 0.3;
        }
        solver_->settle();
    }
}

double DrapeRun::penetration() const {
    const Positions& x = solver_->position();
    Eigen::VectorXd distance(x.rows());
    for (int v = 0; v < x.rows(); ++v) distance[v] = body_->distance(x.row(v).transpose(), contacts_.front()->piece(v));
    return body_penetration(scene_.body->triangle, body_->position(), x, distance);
}

DrapeStatus DrapeRun::judge(const Certificate& certificate) const {
    if (!solver_->position().allFinite()) return DrapeStatus::not_finite;
    if (!(certificate.residual_force <= scene_.gate.residual_force)) return DrapeStatus::not_at_rest;
    if (!(certificate.max_speed <= scene_.solver.speed_tolerance)) return DrapeStatus::not_at_rest;
    if (!(certificate.body_penetration <= scene_.gate.body_penetration)) return DrapeStatus::penetrates_body;
    if (!(certificate.max_stretch <= scene_.gate.max_stretch)) return DrapeStatus::overstretched;
    return DrapeStatus::accepted;
}

DrapeResult DrapeRun::finish() {
    const Positions& x = solver_->position();
    DrapeResult result;
    Certificate& certificate = result.certificate;
    certificate.residual_force = relative_residual();
    {
        const Stopwatch watch(report_.certificate_seconds);
        if (x.allFinite()) {
            certificate.max_speed = solver_->largest_speed();
            if (body_) certificate.body_penetration = penetration();
            certificate.self_intersections = count_self_intersections(scene_.mesh.triangle, x);
        }
        const StretchRange range = stretch_range(shared_.topology, shared_.rest_length, x);
        certificate.max_stretch = range.largest;
        certificate.min_stretch = range.smallest;
    }
    result.status = judge(certificate);
    result.position = x;
    result.report = report_;
    return result;
}

}  // namespace toile::simulate
