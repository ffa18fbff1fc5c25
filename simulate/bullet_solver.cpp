#include "simulate/bullet_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "simulate/bullet_cloth.h"
#include "simulate/contact.h"
#include "simulate/drape_model.h"
#include "simulate/self_contact.h"
#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// Gravity that a weightless cloth's damping is made for [m/s^2].
constexpr double usual_gravity = 9.81;
/// Share of its velocity that what touches itself keeps in a substep of settling: sharp folds chatter.
constexpr double kept_by_sheet = 0.7;

std::vector<Spring> springs_of(const DrapeModel& model) {
    const DrapeScene& scene = model.scene;
    std::vector<Spring> springs = membrane_springs(scene.mesh, model.topology, model.rest_length, scene.membrane);
    if (scene.bending) {
        const std::vector<Spring> bending = bending_springs(scene.mesh, model.topology, *scene.bending);
        springs.insert(springs.end(), bending.begin(), bending.end());
    }
    return springs;
}

class BulletSolver final : public Solver {
  public:
    BulletSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report);

    void start(const Positions& x) override;
    void follow(const Positions& carried) override;
    void settle() override;
    const Positions& position() const override { return state_.position; }
    double residual_force() override;
    double largest_speed() override { return speeds().maxCoeff(); }
    Eigen::VectorXd speeds() override;
    double energy() const override;

  private:
    void begin_step();
    void carry(const Positions& carried);
    void run(int substeps);
    /// All that a trial run changes.
    struct Snapshot {
        BulletCloth::State state;
        Positions force;
        std::vector<SolidTouches::State> touches;
        bool stepped;
    };
    Snapshot snapshot() const;
    void restore(const Snapshot& then);

    const DrapeModel& model_;
    const BulletOptions& options_;
    std::vector<Contact*> contacts_;
    DrapeReport& report_;
    int substeps_;  // in one path step
    double dt_;
    std::vector<Spring> springs_;
    std::vector<SolidTouches> solids_;
    std::optional<SheetTouches> sheet_;
    std::optional<SelfContact> self_contact_;  // for `limit` alone
    std::optional<Wind> wind_;
    std::optional<BulletCloth> cloth_;
    double settling_damping_ = 0.0;  // [1/s]
    BulletCloth::State state_;       // of cloth_
    Positions force_;                // the mean net force over the last run [N]
    bool stepped_ = false;           // since `start`
};

BulletSolver::BulletSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report)
    : model_(model),
      options_(model.scene.solver.bullet),
      contacts_(contacts),
      report_(report),
      substeps_(std::max(1, static_cast<int>(std::ceil(model.scene.solver.time_step / options_.substep - 1e-9)))),
      dt_(model.scene.solver.time_step / substeps_),
      springs_(springs_of(model)) {
    const DrapeScene& scene = model.scene;
    for (const Contact* contact : contacts) solids_.emplace_back(*contact, scene.mesh.vertex_count());
    if (scene.self_contact) {
        Eigen::VectorXd inverse_mass = scene.mesh.mass.cwiseInverse();
        for (int v : scene.pinned) inverse_mass[v] = 0.0;
        sheet_.emplace(scene.mesh, model.topology, *scene.self_contact, inverse_mass);
        self_contact_.emplace(scene.mesh, model.topology, *scene.self_contact, model.pressure);
    }
    if (scene.wind) wind_.emplace(scene.mesh, *scene.wind);
}

void BulletSolver::start(const Positions& x) {
    const SolverOptions& solver = model_.scene.solver;
    const BulletClothSetup setup{model_.scene.mesh.mass,      model_.scene.pinned, springs_, solver.gravity, dt_,
                                 options_.position_iterations};
    cloth_.emplace(setup, x, solids_, sheet_, report_);
    state_ = cloth_->state();
    force_ = Positions::Zero(x.rows(), 3);
    stepped_ = false;
    const double gravity = solver.gravity.norm() > 0.0 ? solver.gravity.norm() : usual_gravity;
    const double length = (x.colwise().maxCoeff() - x.colwise().minCoeff()).maxCoeff();
    settling_damping_ = 2.0 * std::sqrt(gravity / length);
    if (self_contact_) self_contact_->begin_step(x, dt_);
    begin_step();
    for (SolidTouches& solid : solids_) solid.tie(x);
}

void BulletSolver::begin_step() {
    const Stopwatch watch(report_.contact_seconds);
    for (Contact* contact : contacts_) contact->begin_step(state_.position);
    for (SolidTouches& solid : solids_) solid.forget_distances();
}

/// Nothing crosses on the way.
void BulletSolver::carry(const Positions& carried) {
    Positions motion = carried - state_.position;
    if (self_contact_) {
        const Stopwatch watch(report_.self_contact_seconds);
        self_contact_->limit(state_.position, motion);
    }
    state_.before = state_.position += motion;
    cloth_->set_state(state_);
}

void BulletSolver::run(int substeps) {
    force_.setZero();
    for (int k = 0; k < substeps; ++k) {
        if (wind_) {
            wind_->linearise(state_.position, &state_.velocity);
            cloth_->add_force(wind_->force());
        }
        const Positions velocity = std::move(state_.velocity);
        cloth_->substep();
        state_ = cloth_->state();
        force_ += (state_.position - state_.before) / dt_ - velocity;
    }
    force_.array().colwise() *= model_.scene.mesh.mass.array() / (dt_ * substeps);
    for (int v : model_.scene.pinned) force_.row(v).setZero();
    stepped_ = true;
}

void BulletSolver::follow(const Positions& carried) {
    for (SolidTouches& solid : solids_) solid.take_surface_velocities(carried, dt_ * substeps_);
    carry(carried);
    begin_step();
    cloth_->set_damping(model_.scene.solver.damping, 1.0);
    run(substeps_);
    for (SolidTouches& solid : solids_) {
        solid.rest_surface();
        solid.tie(state_.position);
    }
}

void BulletSolver::settle() {
    begin_step();
    cloth_->set_damping(model_.scene.solver.damping + settling_damping_, kept_by_sheet);
    run(options_.settle_substeps);
    for (SolidTouches& solid : solids_) solid.tie(state_.position);
    ++report_.iterations;
}

double BulletSolver::residual_force() {
    if (stepped_) return force_.norm();
    const Snapshot now = snapshot();
    run(1);
    const double force = force_.norm();
    restore(now);
    return force;
}

Eigen::VectorXd BulletSolver::speeds() {
    const Snapshot now = snapshot();
    state_.velocity.setZero();
    cloth_->set_state(state_);
    cloth_->set_damping(model_.scene.solver.damping, 1.0);
    run(substeps_);
    const Eigen::VectorXd speeds = (state_.position - now.state.position).rowwise().norm() / (dt_ * substeps_);
    restore(now);
    return speeds;
}

BulletSolver::Snapshot BulletSolver::snapshot() const {
    Snapshot now{state_, force_, {}, stepped_};
    for (const SolidTouches& solid : solids_) now.touches.push_back(solid.state());
    return now;
}

void BulletSolver::restore(const Snapshot& then) {
    state_ = then.state;
    cloth_->set_state(state_);
    force_ = then.force;
    for (size_t k = 0; k < solids_.size(); ++k) solids_[k].set_state(then.touches[k]);
    stepped_ = then.stepped;
}

double BulletSolver::energy() const {
    const Positions& x = state_.position;
    const Eigen::VectorXd& mass = model_.scene.mesh.mass;
    double energy = wind_ ? wind_->energy(x) : 0.0;
    for (const Spring& spring : springs_) {
        const double stretch = (x.row(spring.first) - x.row(spring.second)).norm() - spring.rest_length;
        energy += 0.5 * spring.stiffness * stretch * stretch;
    }
    for (int v = 0; v < x.rows(); ++v)
        energy += mass[v] * (0.5 * state_.velocity.row(v).squaredNorm() - x.row(v) * model_.scene.solver.gravity);
    return energy;
}

}  // namespace

std::unique_ptr<Solver> make_bullet_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                           DrapeReport& report) {
    return std::make_unique<BulletSolver>(model, contacts, report);
}

}  // namespace toile::simulate
