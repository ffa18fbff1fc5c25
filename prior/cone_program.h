#pragma once

#include <Eigen/Core>
#include <span>

#include "prior/inextensibility.h"

namespace toile::prior {

/// One sample's cone program (paper, Equations 3-5) in units of its own: lengths by the mean edge limit from the
/// predictions' centre, stiffness by its mean. With B_e r = r_a − r_b and u = r − r̂:
///
///     minimise  Σ ½ k_i |u_i|²    subject to    s_e = (l_e^max, B_e r) ∈ Q^4 for every edge
///     dual:     k_i u_i = Σ_e B_eᵀ z_e¹,         z_e ∈ Q^4,      s_e ∘ z_e = 0;      λ_e = z_e⁰,  z_e¹ = −λ_e n_e
///
/// This differs from the paper's Equation 3 in one point: the objective stays quadratic instead of being put into a
/// cone of 3V+1 dimensions with a variable t. Both have the same r*. From (r*, λ) here follows the paper's solution:
/// t = |(√k_i u_i)|, z_0 = (1, −√k_i u_i / t), z_e = (λ_e, −λ_e n_e) / t, y_e = z_e⁰, and the paper's Equation 7
/// gives the same dr (tests/prior/test_cone_program.cpp and test_cone_derivative.cpp check both). The large cone costs
/// accuracy where the prediction is nearly feasible (t and λ vanish together, and z_e is their ratio), its scaling is
/// dense, and it saves nothing. With CVXOPT, patches of 36 vertices with noise of 1 to 1e-6 edge lengths: both forms
/// take 11 to 13 iterations to a gap of 1e-8, the large cone with a residual up to 7 times that of the quadratic
/// objective; asked for 1e-12, the quadratic form got there in 15 to 18, the large cone broke down for every size of
/// noise.
struct ConeProgram {
    Edges edge;                    ///< `[E x 2]`
    Eigen::VectorXd limit;         ///< `[E]` l_e^max
    Eigen::VectorXd stiffness;     ///< `[V]` k_i
    Eigen::Matrix3Xd edge_vector;  ///< `[3 x E]` B_e r̂
    double length_unit = 1.0;      ///< [m]
    double stiffness_unit = 1.0;   ///< [unit of k_i]

    /// Edges, limits and stiffness; no prediction yet.
    explicit ConeProgram(const InextensibilityModel& model);
    void set_predicted(std::span<const double> predicted);

    double force_unit() const { return stiffness_unit * length_unit; }
};

}  // namespace toile::prior
