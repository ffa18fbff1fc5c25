#include "simulate/xpbd_solver.h"

#include <algorithm>
#include <cmath>

#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// No vertex moves further in one small step than the level set's band is deep, or it could pass through a limb unseen
/// [m].
constexpr double largest_move = 0.01;
/// Where the cloth feels itself, no further than this share of the thickness: normals are those of a step's beginning,
/// and layers that the carrying solids press into each other part slowly instead of flying apart.
constexpr double largest_share = 0.5;
/// While settling no vertex is lighter than makes q/m times its stiffness this. The first value is for coming near
/// rest, stiff cloth being soft as sweeps do not get through it; it falls with each stop and settling step to the last,
/// where almost all forces are kept and rest is exact.
constexpr double first_relative_stiffness = 1000.0, last_relative_stiffness = 5.0, fall_per_stop = 0.9,
                 fall_per_step = 0.95;

/// Small steps for measuring a speed over those of a time step.
constexpr int speed_refinement = 8;

Positions weight_of(const DrapeScene& scene) {
    return scene.mesh.mass * scene.solver.gravity.transpose();
}

XpbdSystem make_system(const DrapeModel& model, const std::vector<Contact*>& contacts) {
    const DrapeScene& scene = model.scene;
    XpbdSystem system{
        XpbdConstraints(scene.mesh, model.topology, scene.membrane, scene.bending, model.elasticity.strain_limit()),
        {},
        weight_of(scene)};
    for (const Contact* contact : contacts) system.contacts.emplace_back(*contact);
    return system;
}

XpbdParameters parameters_of(const DrapeScene& scene) {
    const XpbdOptions& options = scene.solver.xpbd;
    XpbdParameters parameters;
    parameters.time_step = scene.solver.time_step / options.substeps;
    parameters.damping = scene.solver.damping;
    parameters.iterations = options.iterations;
    parameters.keep_forces = options.keep_forces;
    parameters.inverse_mass = scene.mesh.mass.cwiseInverse();
    for (int v : scene.pinned) parameters.inverse_mass[v] = 0.0;
    if (scene.contact) parameters.largest_move = largest_move;
    if (scene.self_contact) parameters.largest_move = largest_share * scene.self_contact->thickness;
    return parameters;
}

}  // namespace

XpbdSolver::XpbdSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report)
    : model_(model),
      contacts_(contacts),
      report_(report),
      self_contact_(model.scene.self_contact
                        ? std::optional<XpbdSelfContact>(std::in_place, model.scene.mesh, model.topology,
                                                         *model.scene.self_contact, model.pressure)
                        : std::nullopt),
      system_(make_system(model, contacts)),
      parameters_(parameters_of(model.scene)),
      settling_(parameters_) {
    if (self_contact_) system_.self_contact = &*self_contact_;
    if (model.scene.wind) wind_.emplace(model.scene.mesh, *model.scene.wind);
}

void XpbdSolver::tie(bool solids_moved) {
    const Stopwatch watch(report_.contact_seconds);
    for (size_t k = 0; k < contacts_.size(); ++k) {
        contacts_[k]->begin_step(state_.position);
        system_.contacts[k].tie(solids_moved, state_.touches[k]);
    }
}

void XpbdSolver::keep_anchors() {
    for (size_t k = 0; k < contacts_.size(); ++k) system_.contacts[k].keep_anchors(state_.touches[k]);
}

void XpbdSolver::start(const Positions& x) {
    state_ = system_.state_at(x);
    kinetic_energy_ = 0.0;
    relative_stiffness_ = first_relative_stiffness;
    tie(true);
}

void XpbdSolver::carry(const Positions& carried) {
    if (!self_contact_) {
        state_.position = carried;
        return;
    }
    const Stopwatch watch(report_.self_contact_seconds);
    Positions safe = carried;
    self_contact_->limit(state_.position, safe);
    state_.position = safe;
}

void XpbdSolver::blow() {
    if (!wind_) return;
    wind_->linearise(state_.position);
    system_.weight = weight_of(model_.scene) + wind_->force();
}

void XpbdSolver::follow(const Positions& carried) {
    ++report_.iterations;
    carry(carried);
    blow();
    tie(true);
    for (int k = 0; k < model_.scene.solver.xpbd.substeps; ++k)
        state_ = xpbd_step(system_, parameters_, std::move(state_));
    keep_anchors();
    kinetic_energy_ = 0.0;
    relative_stiffness_ = first_relative_stiffness;
}

void XpbdSolver::add_mass(double relative_stiffness, XpbdParameters& parameters) {
    Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(state_.position.rows());
    system_.constraints.add_stiffness(state_.position, state_.forces, stiffness);
    if (self_contact_) self_contact_->add_stiffness(state_.position, stiffness);
    const double q = parameters.mobility().squared_time;
    for (int v = 0; v < stiffness.size(); ++v) {
        const double lightest = relative_stiffness / (q * stiffness[v]);
        parameters.inverse_mass[v] = std::min(parameters_.inverse_mass[v], lightest);
    }
}

void XpbdSolver::soften(double fall) {
    relative_stiffness_ = std::max(last_relative_stiffness, fall * relative_stiffness_);
}

void XpbdSolver::settle() {
    ++report_.iterations;
    blow();
    tie(false);
    if (settling_.keep_forces) add_mass(relative_stiffness_, settling_);
    for (int k = 0; k < model_.scene.solver.xpbd.substeps; ++k) {
        state_ = xpbd_step(system_, settling_, std::move(state_));
        double energy = 0.0;
        for (int v = 0; v < state_.velocity.rows(); ++v)
            if (settling_.inverse_mass[v] > 0.0)
                energy += state_.velocity.row(v).squaredNorm() / settling_.inverse_mass[v];
        if (energy < kinetic_energy_) {
            state_.velocity.setZero();
            kinetic_energy_ = 0.0;
            soften(fall_per_stop);
        } else {
            kinetic_energy_ = energy;
        }
    }
    keep_anchors();
    soften(fall_per_step);
}

double XpbdSolver::residual_force() {
    Positions force = Positions::Zero(state_.position.rows(), 3);
    model_.elasticity.add_gradient(state_.position, force);
    force = -force;
    for (size_t k = 0; k < system_.contacts.size(); ++k)
        system_.contacts[k].add_static_forces(state_.position, state_.touches[k], force);
    if (self_contact_) self_contact_->add_static_forces(state_.position, force);
    if (wind_) {
        wind_->linearise(state_.position);
        force += wind_->force();
    }
    for (int v : model_.scene.pinned) force.row(v).setZero();
    return force.norm();
}

double XpbdSolver::largest_speed() {
    // Steps so short that the cloth's own masses will do, almost everywhere.
    XpbdParameters parameters = parameters_;
    const int steps = speed_refinement * model_.scene.solver.xpbd.substeps;
    if (parameters.keep_forces) {
        parameters.time_step = model_.scene.solver.time_step / steps;
        add_mass(last_relative_stiffness, parameters);
    }
    XpbdState state = state_;
    state.velocity.setZero();
    for (int k = 0; k < steps; ++k) state = xpbd_step(system_, parameters, std::move(state));
    return std::sqrt((state.position - state_.position).rowwise().squaredNorm().maxCoeff()) /
           (steps * parameters.time_step);
}

}  // namespace toile::simulate
