#include "simulate/xpbd_step.h"

#include <cmath>

namespace toile::simulate {
namespace {

/// Sweeps over contacts alone for each over all constraints where the cloth feels itself: contacts are few, and what
/// one pushes apart another may push together. Self-contact comes last, as what it leaves is cut off.
constexpr int contact_sweeps = 4;

void forget_forces(const XpbdSystem& system, XpbdState& state) {
    state.forces = system.constraints.no_forces();
    for (auto& touches : state.touches) {
        for (XpbdTouch& touch : touches) {
            touch.pressing = 0.0;
            touch.friction.setZero();
        }
    }
}

void bound_moves(const Positions& start, double largest, Positions& x) {
    for (int v = 0; v < x.rows(); ++v) {
        const double length = (x.row(v) - start.row(v)).norm();
        if (length > largest) x.row(v) = start.row(v) + largest / length * (x.row(v) - start.row(v));
    }
}

}  // namespace

XpbdState XpbdSystem::state_at(const Positions& x) const {
    XpbdState state{x, Positions::Zero(x.rows(), 3), constraints.no_forces(), {}};
    for (const XpbdContact& contact : contacts) state.touches.push_back(contact.no_touches());
    return state;
}

XpbdState xpbd_step(const XpbdSystem& system, const XpbdParameters& parameters, XpbdState state) {
    const double h = parameters.time_step;
    const XpbdMobility mobility = parameters.mobility();
    if (!parameters.keep_forces) forget_forces(system, state);
    const Positions start = state.position;
    Positions force = system.weight;
    system.constraints.begin(mobility, start, state.forces, force);
    std::vector<std::vector<int>> near(system.contacts.size());
    for (size_t k = 0; k < system.contacts.size(); ++k) {
        near[k] = system.contacts[k].begin(start, parameters.largest_move, state.touches[k]);
        system.contacts[k].add_forces(near[k], state.touches[k], force);
    }
    XpbdSelfContact* self_contact = system.self_contact;
    if (self_contact) {
        self_contact->begin(mobility, h, parameters.keep_forces, start);
        self_contact->add_forces(force);
    }
    Positions& x = state.position;
    for (int v = 0; v < x.rows(); ++v) {
        if (mobility.inverse_mass[v] == 0.0) continue;
        x.row(v) += mobility.squared_time * (state.velocity.row(v) / h + mobility.inverse_mass[v] * force.row(v));
    }
    if (parameters.largest_move > 0.0) bound_moves(start, parameters.largest_move, x);
    XpbdForces reached = state.forces;
    for (int iteration = 0; iteration < parameters.iterations; ++iteration) {
        system.constraints.sweep(mobility, start, reached, x);
        for (int sweep = 0; sweep < (self_contact ? contact_sweeps : 1); ++sweep) {
            for (size_t k = 0; k < system.contacts.size(); ++k)
                system.contacts[k].sweep(mobility, near[k], state.touches[k], x);
            if (self_contact) self_contact->sweep(mobility, start, x);
        }
    }
    if (parameters.largest_move > 0.0) bound_moves(start, parameters.largest_move, x);
    if (self_contact) self_contact->limit(start, x);
    for (size_t k = 0; k < system.contacts.size(); ++k) system.contacts[k].end(near[k], x, state.touches[k]);
    system.constraints.follow_forces(mobility, x, reached, state.forces);
    state.velocity = (x - start) / h;
    return state;
}

}  // namespace toile::simulate
