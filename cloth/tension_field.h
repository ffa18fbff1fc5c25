#pragma once

#include <Eigen/Core>

namespace toile {

struct MembraneStiffness;

/// Orthotropic St. Venant-Kirchhoff membrane that cannot be squeezed: what compression there would be goes into
/// wrinkles finer than the mesh (relaxed energy, Pipkin 1994, "Relaxed energy densities for large deformations of
/// membranes", with St. Venant-Kirchhoff as the energy):
///
///     ψ_rel(ε) = min over wrinkle strains W ⪰ 0 of ψ(ε + W)
///
/// where ψ is the quadratic form of `MembraneStiffness`. Taut (no W), wrinkled (W of rank one along the direction in
/// which stress would be compressive) and slack (no stress) follow from the minimum. The stress is a continuous
/// function of the strain and positive semidefinite, so ψ_rel is once continuously differentiable, convex in the strain
/// and convex in the positions.
struct TensionField {
    double energy;           ///< per unit of pattern area [N/m]
    Eigen::Vector3d stress;  ///< second Piola-Kirchhoff S_uu, S_vv, S_uv [N/m]
    Eigen::Matrix3d tangent;  ///< ∂S/∂(ε_uu, ε_vv, 2 ε_uv): symmetric, positive semidefinite; on the border of two
                              ///< states that of the tauter one
};

/// `green` is (ε_uu, ε_vv, 2 ε_uv).
TensionField tension_field(const MembraneStiffness& stiffness, const Eigen::Vector3d& green);

}  // namespace toile
