#pragma once

#include <vector>

#include "simulate/xpbd_constraints.h"
#include "simulate/xpbd_contact.h"
#include "simulate/xpbd_self_contact.h"

namespace toile::simulate {

/// Everything that a step changes.
struct XpbdState {
    Positions position;  ///< `[V x 3]` [m]
    Positions velocity;  ///< `[V x 3]`, relative to the solids' motion [m/s]
    XpbdForces forces;
    std::vector<std::vector<XpbdTouch>> touches;  ///< for each solid, each contact point
};

/// What moves: shared by all steps of a drape.
struct XpbdSystem {
    XpbdConstraints constraints;
    std::vector<XpbdContact> contacts;  ///< one for each solid
    Positions weight;                   ///< `[V x 3]`, and other forces that last for the step [N]
    XpbdSelfContact* self_contact = nullptr;

    /// At rest in x, without forces.
    XpbdState state_at(const Positions& x) const;
};

struct XpbdParameters {
    double time_step = 0.0;        ///< h of this one step [s]
    double damping = 0.0;          ///< α, mass-proportional [1/s]
    int iterations = 1;            ///< sweeps over all constraints
    bool keep_forces = true;       ///< start from the forces of the step before instead of none
    double largest_move = 0.0;     ///< no vertex goes further [m]; 0: no bound
    Eigen::VectorXd inverse_mass;  ///< `[V]` [1/kg], 0 where pinned

    XpbdMobility mobility() const { return {time_step * time_step / (1.0 + damping * time_step), inverse_mass}; }
};

/// One small step (Macklin et al. 2019, "Small steps in physics simulation", algorithm 1): from the position that
/// velocity, gravity and the last step's forces lead to, Gauss-Seidel sweeps over all constraints; the velocity is then
/// the move over h. Damping enlarges the mass to m (1 + α h), as in an implicit Euler step.
///
/// A function of its arguments alone. Where nothing moves any more all constraints hold exactly, so a state at rest is
/// a minimum of the energy whatever the step and the iterations, if forces are kept; cloth that is stiff for the step
/// takes long to get there. If they are not (the method as it was published), cloth stretches more than its energy
/// wants by a share that vanishes with the square of the step, and with more iterations.
XpbdState xpbd_step(const XpbdSystem& system, const XpbdParameters& parameters, XpbdState state);

}  // namespace toile::simulate
