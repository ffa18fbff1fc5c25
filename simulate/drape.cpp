#include "simulate/drape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "simulate/collision_body.h"
#include "simulate/contact.h"
#include "simulate/elasticity.h"
#include "simulate/implicit_step.h"
#include "simulate/obstacle.h"
#include "simulate/self_intersection.h"
#include "simulate/stopwatch.h"
#include "skin/surface_query.h"

namespace toile::simulate {
namespace {

/// How far from the garment's neutral drape the body is kept for collision [m]: a sleeve overhead must find head and
/// neck.
constexpr double reach = 0.2;
/// The contact pressure where cloth touches a surface is the membrane's stiffness over this length [m]: a garment
/// stretched by a tenth around a limb then stays clear of it.
constexpr double pressure_length = 0.05;

/// Range of the pseudo time step while the cloth settles [s]; the upper end is statics.
constexpr double shortest_time_step = 1e-3, longest_time_step = 1e3;

BlockMatrix hessian_pattern(const ClothMesh& mesh, const Elasticity& elasticity) {
    return BlockMatrix(mesh.vertex_count(), elasticity.pairs());
}

void check_scene(const DrapeScene& scene) {
    check_cloth_mesh(scene.mesh, "garment");
    if (scene.mesh.mass.size() != scene.mesh.vertex_count() || !(scene.mesh.mass.minCoeff() > 0.0))
        throw Error("every vertex of a garment to be draped needs a mass above 0");
    const bool touches = scene.body || scene.table || scene.sphere;
    if (touches && !scene.contact) throw Error("a scene with a body, a table or a sphere needs contact");
    for (int v : scene.pinned)
        if (v < 0 || v >= scene.mesh.vertex_count())
            throw Error("pinned vertex " + std::to_string(v) + " does not exist");
}

}  // namespace

/// What all drapes share.
struct Draper::Impl {
    DrapeScene scene;
    Topology topology;
    Eigen::VectorXd rest_length;
    Elasticity elasticity;
    BlockMatrix pattern;
    std::vector<ContactPoint> points;
    ReachableSurface surface;
    double pressure = 0.0;
    double weight = 0.0;  // of the garment [N]

    explicit Impl(const DrapeScene& from)
        : scene(from),
          topology(build_topology(scene.mesh.triangle)),
          rest_length(edge_rest_lengths(scene.mesh, topology)),
          elasticity(scene.mesh, topology, scene.membrane, scene.bending, scene.solver.gravity),
          pattern(hessian_pattern(scene.mesh, elasticity)) {
        elasticity.bind(pattern);
        if (scene.contact) {
            points = contact_points(scene.mesh, topology, pattern);
            pressure = std::max(scene.membrane.warp_stiffness, scene.membrane.weft_stiffness) / pressure_length;
        }
        if (scene.body) surface = reachable_surface(*scene.body, scene.mesh.rest_position, reach);
        // Weightless scenes are measured against the same mass under standard gravity.
        const double gravity = scene.solver.gravity.norm();
        weight = scene.mesh.mass.sum() * (gravity > 0.0 ? gravity : 9.81);
    }
};

namespace {

/// One drape under way: state, solids and workspace.
class Run {
  public:
    explicit Run(const Draper::Impl& shared) : shared_(shared), scene_(shared.scene) {
        if (scene_.body) {
            body_ = std::make_unique<CollisionBody>(*scene_.body, scene_.skinning, shared.surface, scene_.level_set,
                                                    scene_.contact->thickness);
            add_contact(*body_);
        }
        if (scene_.table) add_contact(*solids_.emplace_back(std::make_unique<Table>(*scene_.table)));
        if (scene_.sphere) add_contact(*solids_.emplace_back(std::make_unique<Sphere>(*scene_.sphere)));
        std::vector<Contact*> contacts;
        for (auto& contact : contacts_) contacts.push_back(contact.get());
        step_ = std::make_unique<ImplicitStep>(scene_.mesh, shared.elasticity, shared.pattern, scene_.pinned, contacts,
                                               scene_.solver.damping);
    }

    void start(const Positions& x, const skin::Pose& neutral) {
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

    void follow(const skin::Pose& from, const skin::Pose& to);
    void settle();
    DrapeResult finish();

  private:
    void add_contact(const Obstacle& obstacle) {
        contacts_.push_back(std::make_unique<Contact>(*scene_.contact, shared_.pressure, shared_.points, obstacle));
    }
    void begin_step() {
        const Stopwatch watch(report_.contact_seconds);
        for (auto& contact : contacts_) contact->begin_step(x_);
    }
    void end_step() {
        const Stopwatch watch(report_.contact_seconds);
        for (auto& contact : contacts_) contact->end_step(x_);
    }
    double relative_residual() {
        const Stopwatch watch(report_.contact_seconds);
        return step_->static_residual(x_) / shared_.weight;
    }
    void carry_with_body();
    double measure_speed();
    DrapeStatus judge(const Certificate& certificate) const;

    const Draper::Impl& shared_;
    const DrapeScene& scene_;
    std::unique_ptr<CollisionBody> body_;
    std::vector<std::unique_ptr<Obstacle>> solids_;
    std::vector<std::unique_ptr<Contact>> contacts_;
    std::unique_ptr<ImplicitStep> step_;
    Positions x_, carried_, inertial_, velocity_;
    DrapeReport report_;
};

void Run::carry_with_body() {
    carried_ = x_;
    for (int v = 0; v < x_.rows(); ++v)
        carried_.row(v) = body_->carry(x_.row(v).transpose(), contacts_.front()->piece(v)).transpose();
    for (int v : scene_.pinned) carried_.row(v) = x_.row(v);
}

void Run::follow(const skin::Pose& from, const skin::Pose& to) {
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

void Run::settle() {
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

double Run::measure_speed() {
    const double h = scene_.solver.time_step;
    const Positions start = x_;
    Positions next = x_;
    const ImplicitStep::Target target{&start, &start, h};
    DrapeReport unreported;
    step_->iterate(target, next, unreported);
    return std::sqrt((next - start).rowwise().squaredNorm().maxCoeff()) / h;
}

DrapeStatus Run::judge(const Certificate& certificate) const {
    if (!x_.allFinite()) return DrapeStatus::not_finite;
    if (!(certificate.residual_force <= scene_.gate.residual_force)) return DrapeStatus::not_at_rest;
    if (!(certificate.max_speed <= scene_.solver.speed_tolerance)) return DrapeStatus::not_at_rest;
    if (!(certificate.body_penetration <= scene_.gate.body_penetration)) return DrapeStatus::penetrates_body;
    if (!(certificate.max_stretch <= scene_.gate.max_stretch)) return DrapeStatus::overstretched;
    return DrapeStatus::accepted;
}

DrapeResult Run::finish() {
    DrapeResult result;
    Certificate& certificate = result.certificate;
    certificate.residual_force = relative_residual();
    {
        const Stopwatch watch(report_.certificate_seconds);
        if (x_.allFinite()) {
            certificate.max_speed = measure_speed();
            if (body_) certificate.body_penetration = body_penetration(scene_.body->triangle, body_->position(), x_);
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

}  // namespace

Draper::Draper(const DrapeScene& scene) {
    check_scene(scene);
    impl_ = std::make_unique<Impl>(scene);
}
Draper::~Draper() = default;

DrapeResult Draper::drape_neutral() const {
    DrapeResult result;
    double seconds = 0.0;
    {
        const Stopwatch watch(seconds);
        Run run(*impl_);
        const int joints = impl_->scene.body ? impl_->scene.body->joint_count() : 0;
        run.start(impl_->scene.mesh.rest_position, skin::Pose::Zero(joints, 3));
        run.settle();
        result = run.finish();
    }
    result.certificate.seconds = seconds;
    return result;
}

DrapeResult Draper::drape(const Positions& neutral_drape, const skin::Pose& pose) const {
    if (!impl_->scene.body) throw Error("a scene without a body has no poses to drape");
    DrapeResult result;
    double seconds = 0.0;
    {
        const Stopwatch watch(seconds);
        Run run(*impl_);
        const skin::Pose neutral = skin::Pose::Zero(pose.rows(), 3);
        run.start(neutral_drape, neutral);
        run.follow(neutral, pose);
        run.settle();
        result = run.finish();
    }
    result.certificate.seconds = seconds;
    return result;
}

}  // namespace toile::simulate
