#include "simulate/xpbd_solver.h"

#include <cmath>

#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// No vertex moves further in one small step than the level set's band is deep, or it could pass through a limb unseen
/// [m].
constexpr double largest_move = 0.01;

XpbdSystem make_system(const DrapeModel& model, const std::vector<Contact*>& contacts) {
    const DrapeScene& scene = model.scene;
    XpbdSystem system{XpbdConstraints(scene.mesh, model.topology, scene.membrane, scene.bending),
                      {},
                      scene.mesh.mass.cwiseInverse(),
                      scene.solver.gravity};
    for (int v : scene.pinned) system.inverse_mass[v] = 0.0;
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
    if (scene.contact) parameters.largest_move = largest_move;
    return parameters;
}

}  // namespace

XpbdSolver::XpbdSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report)
    : model_(model),
      contacts_(contacts),
      report_(report),
      system_(make_system(model, contacts)),
      parameters_(parameters_of(model.scene)) {}

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
    tie(true);
}

void XpbdSolver::follow(const Positions& carried) {
    ++report_.iterations;
    state_.position = carried;
    tie(true);
    for (int k = 0; k < model_.scene.solver.xpbd.substeps; ++k)
        state_ = xpbd_step(system_, parameters_, std::move(state_));
    keep_anchors();
    kinetic_energy_ = 0.0;
}

double XpbdSolver::kinetic_energy() const {
    return 0.5 * model_.scene.mesh.mass.dot(state_.velocity.rowwise().squaredNorm());
}

void XpbdSolver::settle() {
    ++report_.iterations;
    tie(false);
    for (int k = 0; k < model_.scene.solver.xpbd.substeps; ++k) {
        state_ = xpbd_step(system_, parameters_, std::move(state_));
        const double energy = kinetic_energy();
        if (energy < kinetic_energy_) {
            state_.velocity.setZero();
            kinetic_energy_ = 0.0;
        } else {
            kinetic_energy_ = energy;
        }
    }
    keep_anchors();
}

double XpbdSolver::residual_force() {
    Positions force = Positions::Zero(state_.position.rows(), 3);
    model_.elasticity.add_gradient(state_.position, force);
    force = -force;
    for (size_t k = 0; k < system_.contacts.size(); ++k)
        system_.contacts[k].add_static_forces(state_.position, state_.touches[k], force);
    for (int v : model_.scene.pinned) force.row(v).setZero();
    return force.norm();
}

double XpbdSolver::largest_speed() {
    XpbdState state = state_;
    state.velocity.setZero();
    for (int k = 0; k < model_.scene.solver.xpbd.substeps; ++k)
        state = xpbd_step(system_, parameters_, std::move(state));
    return std::sqrt((state.position - state_.position).rowwise().squaredNorm().maxCoeff()) /
           model_.scene.solver.time_step;
}

}  // namespace toile::simulate
