#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "prior/inextensibility.h"
#include "prior/quasidefinite_ldl.h"

namespace toile::prior {

/// What the edges of a solution do.
struct TautEdges {
    std::vector<int> edge;  ///< those that carry a multiplier, rising
    int weakly_active = 0;  ///< those without force at their limit: λ_e / max λ and 1 − l_e / l_e^max both below 1e-8
    double distance = 1;    ///< smallest, over the edges, of the larger of these two ratios
};

/// An edge counts as taut where its force, relative to the largest, exceeds its relative slack, and as weakly active
/// where neither exceeds 1e-8: so neither a loosely converged multiplier nor a loosely converged length decides alone.
TautEdges find_taut_edges(const InextensibilityModel& model, std::span<const double> position,
                          std::span<const double> multiplier);

/// The derivative of the paper's Section 4 at a solution: the differentials of the cone program's optimality conditions
/// (Equation 7) with ds = S dψ (Equation 8), over the cones of the taut edges (those of loose ones have z = dz = 0):
///
///     [ K   Gᵀ   0  ] [ dr ]   [ K dr̂       ]        G_e = [0 ; −B_e],  S_e = M(s_e),  Z_e = M(z_e)  (Equation 9)
///     [ G   0    S  ] [ dz ] = [ (dl^max, 0) ]        s_e = l_e^max (1, n_e),   z_e = λ_e (1, −n_e)
///     [ 0   S    ZS ] [ dψ ]   [ 0           ]
///
/// With the optimality conditions put in, the block ZS (Equation 10) is symmetric: λ_e l_e^max (0 ⊕ (I − n_e n_eᵀ)).
/// The stationarity row has K in place of the paper's first cone, as the program has (`cone_program.h`).
///
/// The system is singular: always along ψ_e = (1, −n_e), and along multipliers that balance each other where the taut
/// edges are redundant (the paper's Appendix A); dr is unique all the same. It is factored with a small quasi-definite
/// shift, and iterated to the solution of the unshifted system, which never leaves the range of the matrix and so ends
/// at the solution of smallest norm.
class ConeDerivative {
  public:
    ConeDerivative(const InextensibilityModel& model, std::span<const double> position,
                   std::span<const double> multiplier);

    /// ∂L/∂r* `[V x 3]` to ∂L/∂r̂ `[V x 3]` and ∂L/∂l_e^max `[E]` (paper, Equation 11).
    DerivativeReport backward(std::span<const double> loss_gradient, std::span<double> predicted_gradient,
                              std::span<double> edge_max_length_gradient);
    /// Changes of r̂ `[V x 3]` and of the limits `[E]` (or empty) to that of r* `[V x 3]`. Limits that redundant taut
    /// edges cannot follow all at once change r* by the part of them that they can.
    DerivativeReport tangent(std::span<const double> predicted_change, std::span<const double> edge_max_length_change,
                             std::span<double> position_change);

  private:
    void assemble(std::span<const double> position, std::span<const double> multiplier);
    /// Solves for `solution_` from `right_`; the relative residual, of the part that can be met if `inconsistent`.
    double solve(bool inconsistent);
    /// Updates `residual_`.
    double error_of(double size, bool inconsistent);
    DerivativeReport report_of(double residual) const;

    const InextensibilityModel& model_;
    double stiffness_unit_ = 1.0;
    TautEdges taut_;
    double stiffest_ = 1.0;        // largest λ_e / l_e^max, at least 1, in units of the mean stiffness
    SparseMatrix matrix_;          // lower triangle of the system, without shift
    SparseMatrix along_, across_;  // shifts: along multipliers, of size 1; elsewhere, as they are used
    Eigen::VectorXd right_, solution_, residual_, correction_;
};

}  // namespace toile::prior
