#pragma once

#include <memory>
#include <vector>

#include "simulate/solver.h"

namespace toile::simulate {

/// `bullet`: Bullet's position-based soft body (btSoftBody, double precision), stepped as its own dynamics world steps
/// it, without broad phase: every solid of a scene is near.
///
/// Material: edges become links, hinges become links between their opposite vertices (simulate/spring_network.h). A
/// link's kLST in [0, 1] is the share of its length error that one pass removes. For a spring of stiffness K between
/// inverse masses w, implicit Euler removes K h² w / (1 + K h² w) in a substep h, which n passes share:
/// kLST = 1 − (1 + K h² w)^(−1/n). A single link then hangs at its true length whatever h and n. A network does not:
/// where K h² w is above 1 (cotton at 3,000 vertices: 10 at h = 0.5 ms) stiffness comes from how far a pass reaches, so
/// it falls short, more so the finer mesh and the longer the substep, and stretch shrinks as `bullet.substep` shrinks
/// and `bullet.position_iterations` grow. What links cannot say: Poisson's ratio and shear apart (Cauchy symmetry),
/// moment of a nearly flat hinge, contact of edges' middles: a triangle's side may sink into a curved surface.
///
/// Contact: Bullet's rigid contacts with each solid at the contact thickness, filled by a soft-body solver that
/// overrides `processCollision`, in the frame that the solids carry; a contact's body moves with the solid's surface
/// relative to that frame. Of a large mass (1e6 kg), it weighs what the contact pushes: Coulomb's limit of one substep
/// comes from the normal impulse of the one before. Depth is taken back at a bounded speed without gaining velocity.
///
/// `settle` is dynamic relaxation: all velocities are dropped where kinetic energy has passed a peak. `residual_force`
/// is mass times acceleration over the last substep, before damping; speeds are those of one more time step from rest,
/// which is taken back. `solver.damping` slows velocities relative to the carried frame.
///
/// Not felt: the cloth itself (Bullet's soft bodies do not collide vertices and faces of one body with each other),
/// wind, strain limits, the membrane's compression response. Crossings are in the certificate.
///
/// Throws Error in a build without Bullet (-DTOILE_BULLET=OFF).
std::unique_ptr<Solver> make_bullet_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                           DrapeReport& report);

}  // namespace toile::simulate
