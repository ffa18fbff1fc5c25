#pragma once

#include <Eigen/Core>

namespace toile {

/// Deformation gradient [f_u f_v] of a triangle.
using Deformation = Eigen::Matrix<double, 3, 2>;

/// Resistance of a triangle to being squeezed to a line or a point: with its principal stretches λ₁ ≥ λ₂ (the singular
/// values of F),
///
///     ψ = β/6 Σ max(0, λ₀ − λ_i)³,   λ₀ = 0.7,     per unit of pattern area
///
/// twice differentiable, zero where nothing is squeezed below λ₀, finite in a collapsed triangle and with a force there
/// that opens it. With β = 2c it makes up for what St. Venant-Kirchhoff of stiffness c loses below a stretch of 1/√3:
/// the sum's force rises all the way down to λ = 0, and its second derivative along λ never falls below 0.08 c.
///
/// Derivatives by the modes of an isotropic function of singular values (Smith, De Goes, Kim 2019, "Analytic
/// eigensystems for isotropic distortion energies", section 4, for a membrane in space).
class Squeeze {
  public:
    static constexpr double onset = 0.7;  ///< λ₀
    static constexpr double ratio = 2.0;  ///< β over the larger of a membrane's two axes' stiffnesses

    /// Whether λ₂ < λ₀. Costs a few products; everything below need only be asked where it holds.
    static bool acts(const Deformation& deformation);

    /// β in [N/m].
    Squeeze(const Deformation& deformation, double beta);

    double energy() const { return energy_; }
    /// ∂ψ/∂F.
    Deformation stress() const;
    /// Adds `area` times the Hessian in the corners' positions, corner by corner. `corner_gradient` as in
    /// `MembraneStencil`. Projected: without the modes of negative curvature, positive semidefinite.
    void add_hessian(const Deformation& corner_gradient, double area, bool projected,
                     Eigen::Matrix<double, 9, 9>& hessian) const;

  private:
    double stretch_[2];           // λ
    double slope_[2], curve_[2];  // of β/6 max(0, λ₀ − λ)³ at each
    double energy_;
    Eigen::Matrix<double, 2, 2> inner_;  // columns: principal directions in the pattern
    Eigen::Matrix<double, 3, 3> outer_;  // columns: where they point in space, and the normal
};

}  // namespace toile
