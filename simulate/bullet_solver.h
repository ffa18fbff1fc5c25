#pragma once

#include <memory>
#include <vector>

#include "simulate/solver.h"

namespace toile::simulate {

/// `bullet`: Bullet's position-based soft body (btSoftBody, double precision), stepped as its own dynamics world steps
/// it, without broad phase: every solid of a scene is near.
///
/// Material: edges become links, hinges become links between their opposite vertices (simulate/spring_network.h), each
/// with the share of its length error that a pass removes as implicit Euler would (simulate/bullet_cloth.h). A single
/// link then hangs at its true length whatever the substep and passes. A network does not: where K h² w is above 1
/// (cotton at 3,000 vertices: 10 at h = 0.5 ms) stiffness comes from how far a pass reaches, so it falls short, more so
/// the finer mesh and the longer the substep, and stretch shrinks as `bullet.substep` shrinks and
/// `bullet.position_iterations` grow. What links cannot say: Poisson's ratio and shear apart (Cauchy symmetry), moment
/// of a nearly flat hinge, contact of edges' middles with solids: a triangle's side may sink into a curved surface.
///
/// Contact: Bullet's rigid contacts with each solid at the contact thickness, filled by a soft-body solver that
/// overrides `processCollision`, in the frame that the solids carry; a contact's body moves with the solid's surface
/// relative to that frame (simulate/solid_touch.h).
///
/// Self-contact: Bullet's soft contacts (PSolve_SContacts), filled by the same solver from its own search
/// (simulate/sheet_touch.h). Of Bullet's own searches, VF_SS leaves a body's contact with itself out, and CL_SELF knows
/// convex clusters only, which a sheet's folds are not. Pairs are kept on their sides as far as passes reach: mostly
/// nothing crosses, but nothing proves it, as it is with `implicit`. On the way to a pose the body carries the cloth
/// only as far as nothing crosses. Sharp folds, where no thickness fits, may chatter: such drapes do not rest.
///
/// Wind: simulate/wind.h, each substep. (Bullet's own lets drag add no more than the speed a vertex has: none at rest.)
///
/// `settle` damps as a pendulum of the garment's length would be critically damped. `residual_force` is mass times
/// acceleration, before damping, averaged over the last run; speeds are those of one more time step from rest, which is
/// taken back. `solver.damping` slows velocities relative to the carried frame.
///
/// Not felt: strain limits, the membrane's compression response.
///
/// Throws Error in a build without Bullet (-DTOILE_BULLET=OFF).
std::unique_ptr<Solver> make_bullet_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                           DrapeReport& report);

}  // namespace toile::simulate
