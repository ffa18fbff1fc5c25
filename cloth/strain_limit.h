#pragma once

#include "cloth/membrane.h"

namespace toile {

/// Largest stretches of a cloth along its two axes, and how hard it resists beyond:
///
///     ψ = κ/6 (max(0, |f_u| − L_u)³ + max(0, |f_v| − L_v)³)     per unit of pattern area
///
/// with the columns f_u, f_v of F (Wang, O'Brien, Ramamoorthi 2010 limit principal strains instead; warp and weft are
/// what the inextensibility prior limits). Twice differentiable; nothing happens below the limit. The tension at 1 %
/// beyond is 5e-5 κ, and grows with the square: it bends stiffly without the infinite values of a barrier, so a cloth
/// may start beyond its limit.
struct StrainLimit {
    double u, v;       ///< L, above 1
    double stiffness;  ///< κ [N/m]

    /// κ such that a cloth 1 % beyond its limit carries `tension` [N/m].
    static StrainLimit carrying(double u, double v, double tension) { return {u, v, tension / (0.5 * 0.01 * 0.01)}; }
};

double strain_limit_energy(const MembraneStencil& stencil, const StrainLimit& limit, const TrianglePositions& x);
TriangleGradient strain_limit_gradient(const MembraneStencil& stencil, const StrainLimit& limit,
                                       const TrianglePositions& x);
/// Positive semidefinite as it is: there is no projected one.
TriangleHessian strain_limit_hessian(const MembraneStencil& stencil, const StrainLimit& limit,
                                     const TrianglePositions& x);

/// Whether a triangle is beyond its limit: the three above are zero where it isn't.
bool strain_limit_acts(const MembraneStencil& stencil, const StrainLimit& limit, const TrianglePositions& x);

}  // namespace toile
