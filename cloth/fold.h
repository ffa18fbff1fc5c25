#pragma once

#include <Eigen/Core>

#include "cloth/bending.h"

namespace toile {

/// Hinge bending of a cloth whose rest state is folded: discrete shells (Grinspun et al. 2003) with the fold's angle θ
/// measured against its rest angle θ₀ through 2 sin((θ − θ₀) / 2), as Bridson et al. 2003 do:
///
///     E = ½ k |ē|² / (A_0 + A_1) · 4 sin²((θ − θ₀) / 2) · m_0 m_1,     ē, A from the pattern
///
/// With θ₀ = 0 this is the form of cloth/bending.h as long as lengths are kept, with the same k [N m]. The energy is a
/// smooth function of the positions for all angles: it has its largest value, not a jump, half a turn away from θ₀. The
/// m are 1, but for a triangle that has lost more than 19/20 of its area; then they go to zero with it, twice
/// differentiable: the angle of a triangle that is a line means nothing, and its derivatives have no bound.
struct FoldStencil {
    double scale;           ///< |ē|² / (A_0 + A_1), without a unit
    double rest_angle;      ///< θ₀, −π to π; folds away from the triangles' outside are positive
    Eigen::Vector2d taper;  ///< |normal| = twice the area below which each triangle counts less [m^2]
};

/// Angle θ of the hinge (a, b, c, d): 0 where it is flat, 0 also where a triangle has no area.
double fold_angle(const HingePositions& x);

/// Stencil of the hinge (a, b, c, d) between the triangles `first` (with c) and `second` (with d), with the angle the
/// hinge has in `mesh.rest_position`.
FoldStencil fold_stencil(const ClothMesh& mesh, const Eigen::Vector4i& hinge, int first, int second);

using FoldGradient = Eigen::Matrix<double, 12, 1>;  ///< vertex by vertex
using FoldHessian = Eigen::Matrix<double, 12, 12>;

double fold_energy(const FoldStencil& stencil, double stiffness, const HingePositions& x);
/// c = 2 sin((θ − θ₀) / 2) √(|ē|² / (A_0 + A_1) m_0 m_1) and its gradient: E = ½ k c². Zero where a triangle has no
/// area.
struct FoldMeasure {
    double value = 0.0;
    FoldGradient gradient = FoldGradient::Zero();
};
FoldMeasure fold_measure(const FoldStencil& stencil, const HingePositions& x);
FoldGradient fold_gradient(const FoldStencil& stencil, double stiffness, const HingePositions& x);
/// Without the derivatives of m: exact where both triangles have more than a twentieth of their area.
FoldHessian fold_hessian(const FoldStencil& stencil, double stiffness, const HingePositions& x);
/// Gauss-Newton: positive semidefinite, of rank one, the true Hessian at the rest angle.
FoldHessian fold_projected_hessian(const FoldStencil& stencil, double stiffness, const HingePositions& x);

}  // namespace toile
