#include "simulate/implicit_solver.h"

#include <algorithm>
#include <cmath>

#include "simulate/stopwatch.h"

namespace toile::simulate {
namespace {

/// Range of the pseudo time step while the cloth settles [s]; the upper end is statics.
constexpr double shortest_time_step = 1e-3, longest_time_step = 1e3;
/// From this pseudo time step on the Hessian's true curvature tells where to go [s]; before, it would have the cloth
/// leap from where it falls to.
constexpr double nearly_static = 1.0;

}  // namespace

ImplicitSolver::ImplicitSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report)
    : model_(model),
      contacts_(contacts),
      report_(report),
      self_contact_(model.scene.self_contact
                        ? std::optional<SelfContact>(std::in_place, model.scene.mesh, model.topology,
                                                     *model.scene.self_contact, model.pressure)
                        : std::nullopt),
      step_(model.scene.mesh, model.elasticity, model.symbolic, model.scene.pinned, contacts,
            self_contact_ ? &*self_contact_ : nullptr, model.scene.solver.damping) {
    if (model.scene.wind) step_.expose_to(&wind_.emplace(model.scene.mesh, *model.scene.wind));
}

void ImplicitSolver::start(const Positions& x) {
    x_ = x;
    velocity_ = Positions::Zero(x.rows(), 3);
    time_step_ = model_.scene.solver.time_step;
    begin_step();
}

void ImplicitSolver::begin_step() {
    const Stopwatch watch(report_.contact_seconds);
    step_.contacts_changed();
    for (Contact* contact : contacts_) contact->begin_step(x_);
    if (self_contact_) self_contact_->begin_step(x_, time_step_);
}

void ImplicitSolver::end_step() {
    const Stopwatch watch(report_.contact_seconds);
    step_.contacts_changed();
    for (Contact* contact : contacts_) contact->end_step(x_);
    if (self_contact_) self_contact_->begin_step(x_, time_step_);
}

void ImplicitSolver::carry(const Positions& carried) {
    if (!self_contact_) {
        x_ = carried;
        return;
    }
    const Stopwatch watch(report_.self_contact_seconds);
    Positions motion = carried - x_;
    self_contact_->limit(x_, motion);
    x_ += motion;
}

void ImplicitSolver::follow(const Positions& carried) {
    const double h = model_.scene.solver.time_step;
    carry(carried);
    step_.moved();
    inertial_ = carried + h * velocity_;
    begin_step();
    const ImplicitStep::Target target{&carried, &inertial_, h, false};
    for (int iteration = 0; iteration < model_.scene.schedule.path_iterations; ++iteration) {
        const ImplicitStep::Iteration done = step_.iterate(target, x_, report_);
        if (done.largest_move < model_.scene.schedule.path_tolerance) break;
    }
    velocity_ = (x_ - carried) / h;
    time_step_ = h;
    end_step();
    begin_step();
}

void ImplicitSolver::settle() {
    before_ = x_;
    const ImplicitStep::Target target{&before_, &before_, time_step_, time_step_ >= nearly_static};
    const ImplicitStep::Iteration done = step_.iterate(target, x_, report_);
    end_step();
    double growth = 2.0;
    if (wind_) {
        // The wind's force lags one step behind the cloth: the step grows only as fast as the residual falls (switched
        // evolution relaxation, Mulder and van Leer 1985), or the two would swing about the rest.
        const double residual = step_.static_residual(x_, report_);
        if (last_residual_ > 0.0 && residual > 0.0) growth = std::clamp(last_residual_ / residual, 0.5, 2.0);
        last_residual_ = residual;
    }
    if (done.halvings == 0) time_step_ = std::clamp(growth * time_step_, shortest_time_step, longest_time_step);
    if (done.halvings > 1) time_step_ = std::max(0.5 * time_step_, shortest_time_step);
}

double ImplicitSolver::residual_force() {
    return step_.static_residual(x_, report_);
}

double ImplicitSolver::energy() const {
    double energy = model_.elasticity.energy(x_);
    if (wind_) energy += wind_->energy(x_);
    for (const Contact* contact : contacts_) energy += contact->energy(x_);
    if (self_contact_) energy += self_contact_->energy(x_);
    return energy - held_by_friction();
}

double ImplicitSolver::held_by_friction() const {
    double held = 0.0;
    for (const Contact* contact : contacts_) held += contact->friction_energy(x_);
    return held;
}

Eigen::VectorXd ImplicitSolver::speeds() {
    const double h = model_.scene.solver.time_step;
    before_ = x_;
    Positions next = x_;
    const ImplicitStep::Target target{&before_, &before_, h, false};
    DrapeReport unreported;
    step_.iterate(target, next, unreported);
    return (next - before_).rowwise().norm() / h;
}

}  // namespace toile::simulate
