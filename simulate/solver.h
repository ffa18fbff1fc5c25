#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "cloth/types.h"
#include "simulate/drape.h"

namespace toile::simulate {

class Contact;
struct DrapeModel;

/// What moves the cloth of one drape. A solver reads material, bending, pins and schedule from the model; it feels the
/// scene's solids through one `Contact` each, whose ties of points to pieces of the solid (`Contact::begin_step`) it
/// renews itself. State of one drape: one object for one thread.
class Solver {
  public:
    virtual ~Solver() = default;

    /// Sets out from x `[V x 3]`, at rest. The contacts' ties are set.
    virtual void start(const Positions& x) = 0;
    /// One path step of `solver.time_step`: the solids have just moved, and would take the cloth to `carried` `[V x
    /// 3]`. Velocities are relative to that motion.
    virtual void follow(const Positions& carried) = 0;
    /// One step towards rest where the solids are now. Adds to `report.iterations`.
    virtual void settle() = 0;

    virtual const Positions& position() const = 0;
    /// Euclidean norm of all nodal net forces where the cloth is now [N].
    virtual double residual_force() = 0;
    /// The largest speed with which a vertex would set out from where it is now [m/s].
    virtual double largest_speed() = 0;
    /// That of every vertex `[V]` [m/s]; a solver that knows only the largest says it of all.
    virtual Eigen::VectorXd speeds() { return Eigen::VectorXd::Constant(position().rows(), largest_speed()); }
    /// Potential and kinetic energy of the cloth where it is now [J]: what a step towards rest must not raise. NaN
    /// where a solver's forces have no energy.
    virtual double energy() const { return std::numeric_limits<double>::quiet_NaN(); }
    /// What the springs hold that stand for sticking friction [J], which is not part of `energy`: a step can give no
    /// more than that back to the cloth.
    virtual double held_by_friction() const { return 0.0; }
};

/// The solver that `model.scene.solver.solver` names. Model, contacts and report must outlive it.
std::unique_ptr<Solver> make_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                    DrapeReport& report);

}  // namespace toile::simulate
