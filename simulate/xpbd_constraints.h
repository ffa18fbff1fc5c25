#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "cloth/bending.h"
#include "cloth/cloth_mesh.h"
#include "cloth/fold.h"
#include "cloth/membrane.h"
#include "cloth/strain_limit.h"
#include "cloth/topology.h"
#include "simulate/material.h"
#include "simulate/xpbd_bending.h"
#include "simulate/xpbd_membrane.h"
#include "simulate/xpbd_mobility.h"

namespace toile::simulate {

/// The multipliers of elastic constraints as forces: at rest they are the stresses of the energy. Part of a state, so
/// that a step starts from the forces of the one before.
struct XpbdForces {
    Positions membrane;       ///< `[F x 3]` pattern area times second Piola-Kirchhoff stress (uu, vv, uv) [N m]
    Eigen::VectorXd squeeze;  ///< `[F]` pattern area times the root of twice cloth/squeeze.h's energy
    PlanePositions limit;     ///< `[F x 2]` pattern area times the strain limit's tension [N m], `[0 x 2]` without one
    Positions bending;        ///< `[H x 3]` stiffness times Σ w x of each hinge that is flat at rest [N]
    Eigen::VectorXd folding;  ///< `[K]` stiffness times measure (cloth/fold.h) of each hinge that is folded at rest
};

/// Membrane and bending energies as compliant constraints (Macklin, Müller, Chentanez 2016, "XPBD", eq. 18), one block
/// for a triangle's three strains and one for a hinge's curvature vector. With ψ = A W(ε) the multiplier s of a block
/// is to become A ∂W/∂ε; linearised, with J the gradient of ε, G = J M⁻¹ Jᵀ and D = A ∂²W/∂ε²,
///
///     (1 + q D G) Δs = A ∂W/∂ε(x) − s,        x ← x − q M⁻¹ Jᵀ Δs,
///
/// which for constant D is eq. 18 with compliance D⁻¹, and which also knows membranes that have no stiffness in some
/// direction. J is taken where the step began, as in SHAKE: forces then have no torque about the positions they
/// started from, so that a step keeps angular momentum to rounding; it is taken at x, as published, where a force is so
/// large that a direction that lags by a step would not be stable. Squeeze and folds, energies A ½ C² of
/// one number C, have one multiplier each; the strain limit has one for each axis, and its cubic energy is minimised
/// exactly.
class XpbdConstraints {
  public:
    XpbdConstraints(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
                    const std::optional<BendingOptions>& bending,
                    const std::optional<StrainLimit>& strain_limit = std::nullopt);

    XpbdForces no_forces() const;
    /// Adds a bound on the stiffness that each vertex meets `[V]` [N/m]: the row sums, without signs, of the energy's
    /// Hessian in the rest state and of what the forces resist to turning.
    void add_stiffness(const Positions& x, const XpbdForces& forces, Eigen::VectorXd& stiffness) const;
    /// Makes forces of an earlier step fit to start from, and adds what they are on the vertices `[V x 3]` [N]: those
    /// that are too large to lag behind by a step are scaled down, each triangle's for itself, and hinges' are turned
    /// along their curvature.
    void begin(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces, Positions& total) const;
    /// Lets the forces that the next step starts from follow those that this step reached at x.
    void follow_forces(const XpbdMobility& mobility, const Positions& x, const XpbdForces& reached,
                       XpbdForces& kept) const;
    /// One Gauss-Seidel sweep over all blocks.
    void sweep(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces, Positions& x) const;

  private:
    struct Triangle {
        int vertex[3];
        MembraneStencil stencil;
    };
    struct FoldedHinge {
        int vertex[4];
        FoldStencil stencil;
    };
    void add_hinges(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options);
    void sweep_squeeze(const XpbdMobility& mobility, const Triangle& triangle, const Positions& start, double& force,
                       Positions& x) const;
    void sweep_limit(const XpbdMobility& mobility, const Triangle& triangle, const Positions& start,
                     Eigen::Ref<Eigen::RowVector2d> force, Positions& x) const;
    /// Of a tension that grows with the square of what is beyond the limit [N m].
    double limit_stiffness(const Triangle& triangle) const {
        return 0.5 * triangle.stencil.area * strain_limit_->stiffness;
    }
    void sweep_folded(const XpbdMobility& mobility, const FoldedHinge& hinge, double& force, Positions& x) const;
    /// q times the stiffness against turning that a triangle's stress, of this spectral norm, is for a vertex.
    static double lag(const XpbdMobility& mobility, const Triangle& triangle, double stress);
    double limit_slope(const Triangle& triangle, double force) const {
        return 2.0 * std::sqrt(limit_stiffness(triangle) * force);
    }
    void follow_scalars(const XpbdMobility& mobility, const Positions& x, const XpbdForces& reached,
                        XpbdForces& kept) const;

    MembraneStiffness stiffness_;
    XpbdMembrane membrane_;
    XpbdBending bending_;  // it or folded_hinge_ is empty
    std::vector<Triangle> triangle_;
    std::optional<StrainLimit> strain_limit_;
    std::vector<FoldedHinge> folded_hinge_;
    double bending_stiffness_ = 0.0;
};

}  // namespace toile::simulate
