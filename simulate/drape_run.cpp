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

/// Contact is stiffened by this factor, this often at most, while depth falls to this share.
constexpr double stiffening = 4.0, least_gain = 0.8;
constexpr int most_stiffenings = 8;

/// Notices that a drape no longer gets anywhere: neither its residual falls nor its energy, told as the height it would
/// lift the garment to [m]. In stiff cloth the residual swings about while the cloth still moves.
class Progress {
  public:
    /// `extent` of the garment [m]: what falls by more than that is not held by anything.
    explicit Progress(double extent) : extent_(extent) {}

    void residual_is(double residual, int iteration) {
        if (residual >= 0.9 * best_) return;
        best_ = residual;
        since_ = iteration;
    }
    /// NaN: not known.
    void energy_is(double height, int iteration) {
        if (looks_++ <= looks_at_start) start_ = height;
        if (!(height < lowest_ - least_fall)) return;
        lowest_ = height;
        if (height > start_ - extent_) since_ = iteration;
    }
    bool stalled(int iteration, int patience) const { return iteration - since_ >= patience; }

    static constexpr int energy_interval = 25;  ///< iterations between two looks at the energy

  private:
    static constexpr double least_fall = 1e-5;  // [m]
    static constexpr int looks_at_start = 2;    // while a start that is far from rest gives off its elastic energy

    double extent_, start_ = 0.0;
    double best_ = std::numeric_limits<double>::infinity(), lowest_ = best_;
    int since_ = 0, looks_ = 0;
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

double DrapeRun::deepest() const {
    const Positions& x = solver_->position();
    const double near = 0.25 * scene_.contact->thickness;
    double depth = 0.0;
    bool near_body = false;
    for (const auto& contact : contacts_) {
        const bool is_body = &contact->obstacle() == body_.get();
        for (int v = 0; v < x.rows(); ++v) {
            const double distance = contact->obstacle().distance(x.row(v).transpose(), contact->piece(v));
            if (is_body)
                near_body |= distance < near;
            else
                depth = std::max(depth, -distance);
        }
    }
    return near_body ? std::max(depth, penetration()) : depth;
}

void DrapeRun::settle(const EnergyWatch& watch) {
    come_to_rest(watch);
    if (contacts_.empty() || !scene_.gate.body_penetration) return;
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_stiffenings && solver_->position().allFinite(); ++round) {
        const double depth = deepest();
        // What two surfaces squeeze is not helped by stiffer ones.
        if (depth <= *scene_.gate.body_penetration || depth > least_gain * before) return;
        before = depth;
        for (auto& contact : contacts_) contact->stiffen(stiffening);
        come_to_rest(watch);
    }
}

void DrapeRun::come_to_rest(const EnergyWatch& watch) {
    bool first = true;
    double target_residual = scene_.solver.residual_tolerance;
    const int last = report_.iterations + scene_.solver.max_iterations;
    const Positions& x = solver_->position();
    Progress progress((x.colwise().maxCoeff() - x.colwise().minCoeff()).norm());
    int step = 0;
    while (report_.iterations < last) {
        const double residual = relative_residual();
        if (watch) watch({solver_->energy(), solver_->held_by_friction(), std::exchange(first, false)});
        if (!std::isfinite(residual)) return;
        progress.residual_is(residual, report_.iterations);
        if (step++ % Progress::energy_interval == 0)
            progress.energy_is(solver_->energy() / shared_.weight, report_.iterations);
        if (progress.stalled(report_.iterations, scene_.solver.stall_iterations)) return;
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
