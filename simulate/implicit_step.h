#pragma once

#include <memory>
#include <vector>

#include "simulate/contact.h"
#include "simulate/coupled_hessian.h"
#include "simulate/drape.h"
#include "simulate/elasticity.h"
#include "simulate/self_contact.h"
#include "simulate/trust_region.h"
#include "simulate/wind.h"

namespace toile::simulate {

/// One implicit Euler step as a minimum (Martin et al. 2011; Li et al. 2020):
///
///     Φ(x) = 1/(2h²) Σ m |x − y|² + α/(2h) Σ m |x − c|² + Ψ(x) + contact(x) + friction(x)
///
/// with c where the moving solids carry the cloth, y = c + h v the inertial target, α the damping, and Ψ membrane,
/// bending and weight. Solved by Newton's method with a positive definite Hessian and a backtracking line search;
/// where the cloth feels itself, on motions that cross nothing. The positive definite Hessian is too stiff along folds
/// that are forming; with true curvature it only preconditions, and a trust region bounds the step. `self_contact` may
/// be null.
class ImplicitStep {
  public:
    ImplicitStep(const ClothMesh& mesh, const Elasticity& elasticity, std::shared_ptr<const BlockSymbolic> symbolic,
                 const std::vector<int>& pinned, std::vector<Contact*> contacts, SelfContact* self_contact,
                 double damping);

    /// Wind that acts on the cloth from now on, taken anew in each iteration; null for none.
    void expose_to(Wind* wind) { wind_ = wind; }

    struct Target {
        const Positions* carried;     ///< c
        const Positions* inertial;    ///< y
        double time_step;             ///< h [s]
        bool true_curvature = false;  ///< worth its price where the cloth is to come to rest
    };
    struct Iteration {
        int halvings = 0;           ///< of the line search
        double step_share = 0.0;    ///< accepted share of the Newton step; 0 where no share lowered Φ
        double largest_move = 0.0;  ///< [m]
        double decrease = 0.0;      ///< of Φ, by the step before it is lengthened [J]
    };
    /// One Newton iteration from x, in place.
    Iteration iterate(const Target& target, Positions& x, DrapeReport& report);

    /// To be called where contacts have begun or ended a step.
    void contacts_changed() { linearised_at_.resize(0, 3); }
    /// To be called where the cloth has been carried somewhere else.
    void moved() { region_.reset(); }

    /// Net force on each vertex at rest, without inertia and damping, friction's normal forces taken at x. Zero on
    /// pinned ones. Returns its Euclidean norm [N].
    double static_residual(const Positions& x, DrapeReport& report);

  private:
    double energy(const Target& target, const Positions& x) const;
    void gradient_of(const Target& target, const Positions& x);
    bool newton_direction(const Positions& x, double inertia, DrapeReport& report);
    void go_by_true_curvature(const Positions& x, DrapeReport& report);
    void linearise(const Positions& x, DrapeReport& report);
    /// Moves x along direction_.
    Iteration descend(const Target& target, Positions& x, DrapeReport& report);
    /// Shortens direction_ until nothing crosses; false where it then no longer points downhill.
    bool make_safe(const Positions& x, DrapeReport& report);
    double lengthen(const Target& target, const Positions& x, double share, double longest, double energy_there);
    void clear_pinned(Positions& rows) const;

    const ClothMesh& mesh_;
    const Elasticity& elasticity_;
    std::vector<bool> pinned_;  // of each vertex
    std::vector<Contact*> contacts_;
    SelfContact* self_contact_;
    Wind* wind_ = nullptr;
    double damping_;
    CoupledHessian hessian_;
    TrustRegion region_;
    std::vector<double> softening_;
    Positions gradient_, direction_, trial_;
    Positions linearised_at_;  // empty where it must be done again
};

}  // namespace toile::simulate
