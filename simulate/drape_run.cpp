#include "simulate/drape_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "simulate/body_intersection.h"
#include "simulate/certificate.h"
#include "simulate/self_intersection.h"
#include "simulate/stopwatch.h"
#include "simulate/untangle.h"
#include "skin/surface_query.h"

namespace toile::simulate {
namespace {

/// Notices that a residual has stopped falling.
class Progress {
  public:
    bool stalled(double residual, int iteration, int patience) {
        if (residual < 0.9 * best_) {
            best_ = residual;
            since_ = iteration;
        }
        return iteration - since_ >= patience;
    }

  private:
    double best_ = std::numeric_limits<double>::infinity();
    int since_ = 0;
};

}  // namespace

DrapeRun::DrapeRun(const DrapeModel& shared) : shared_(shared), scene_(shared.scene) {
    if (scene_.body) {
        body_ =
            std::make_unique<CollisionBody>(*scene_.body, scene_.skinning, scene_.level_set, scene_.contact->thickness);
        add_contact(*body_);
    }
    if (scene_.table) add_contact(*solids_.emplace_back(std::make_unique<Table>(*scene_.table)));
    if (scene_.sphere) add_contact(*solids_.emplace_back(std::make_unique<Sphere>(*scene_.sphere)));
    std::vector<Contact*> contacts;
    for (auto& contact : contacts_) contacts.push_back(contact.get());
    solver_ = make_solver(shared, contacts, report_);
}

void DrapeRun::start(const Positions& x, const skin::Pose& neutral) {
    Positions clear = x;
    if (scene_.self_contact && x.allFinite()) {
        // What crosses from the start would be kept crossing: no motion may pass through.
        const Stopwatch watch(report_.self_contact_seconds);
        const UntangleReport untangled =
            untangle(scene_.mesh.triangle, shared_.topology, scene_.pinned, UntangleOptions{}, clear);
        report_.untangled = untangled.crossings_before - untangled.crossings_after;
    }
    if (body_) tie_to_body(clear, neutral);
    solver_->start(clear);
}

void DrapeRun::tie_to_body(const Positions& x, const skin::Pose& neutral) {
    body_->start(neutral, shared_.neutral);
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
        body_->move_to(skin::interpolate(from, to, static_cast<double>(k) / steps), report_);
        carry_with_body();
        body_->fit_level_set(k == steps, carried_, report_);
        solver_->follow(carried_);
    }
}

void DrapeRun::settle(const EnergyWatch& watch) {
    bool first = true;
    double target_residual = scene_.solver.residual_tolerance;
    const int last = report_.iterations + scene_.solver.max_iterations;
    Progress progress;
    while (report_.iterations < last) {
        const double residual = relative_residual();
        if (watch) watch(solver_->energy(), std::exchange(first, false));
        if (!std::isfinite(residual)) return;
        if (progress.stalled(residual, report_.iterations, scene_.solver.stall_iterations)) return;
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

Certificate DrapeRun::certify() {
    const Positions& x = solver_->position();
    Certificate certificate;
    certificate.residual_force = relative_residual();
    certificate.iterations = report_.iterations;
    certificate.path_steps = report_.path_steps;
    const StretchRange range = stretch_range(shared_.topology, shared_.rest_length, x);
    certificate.max_stretch = range.largest;
    certificate.min_stretch = range.smallest;
    if (!x.allFinite()) return certificate;
    const Eigen::VectorXd speed = solver_->speeds();
    certificate.max_speed = speed.maxCoeff();
    certificate.moving_share =
        static_cast<double>((speed.array() > moving_speed).count()) / static_cast<double>(speed.size());
    certificate.self_intersections = count_self_intersections(scene_.mesh.triangle, x);
    if (!body_) return certificate;
    certificate.body_penetration = penetration();
    certificate.body_crossings =
        count_crossing_pairs(scene_.mesh.triangle, x, scene_.body->triangle, body_->position());
    return certificate;
}

DrapeResult DrapeRun::finish() {
    DrapeResult result;
    {
        const Stopwatch watch(report_.certificate_seconds);
        result.certificate = certify();
    }
    result.position = solver_->position();
    result.status = judge(result.certificate, result.position.allFinite(), scene_.gate);
    result.report = report_;
    return result;
}

}  // namespace toile::simulate
