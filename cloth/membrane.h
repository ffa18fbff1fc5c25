#pragma once

#include <Eigen/Core>

#include "cloth/cloth_mesh.h"

namespace toile {

/// What a membrane answers where it is squeezed in its own plane.
enum class Compression {
    /// St. Venant-Kirchhoff's stress, stiffened below a stretch of 0.7 (see cloth/squeeze.h), so that the force against
    /// squeezing never falls again on the way to a collapsed triangle. (Alone it falls below a stretch of 1/√3.)
    full,
    /// None: the triangle wrinkles below the mesh's resolution (see cloth/tension_field.h). The energy is then convex.
    tension_field,
};

/// Orthotropic St. Venant-Kirchhoff membrane per unit of pattern area, u = weft, v = warp.
///
/// With deformation gradient F = [f_u f_v] `[3 x 2]` and Green strain ε = (FᵀF − I)/2:
///
///     ψ = ½ c_uu ε_uu² + ½ c_vv ε_vv² + c_uv ε_uu ε_vv + ½ c_s (2 ε_uv)²     [N/m]
///
/// where no direction is squeezed; where one is, `compression` says.
struct MembraneStiffness {
    double uu, vv, uv, shear;  ///< [N/m]
    Compression compression = Compression::full;

    /// c_uu = E_u / (1 − ν²), c_vv = E_v / (1 − ν²), c_uv = ν √(E_u E_v) / (1 − ν²): positive definite for |ν| < 1.
    static MembraneStiffness from_moduli(double weft, double warp, double shear, double poisson_ratio,
                                         Compression compression = Compression::full);
};

/// One triangle's rest state: what maps its corners to a deformation gradient.
struct MembraneStencil {
    Eigen::Matrix<double, 3, 2> corner_gradient;  ///< row i: gradient of corner i's hat function in the pattern [1/m]
    double area;                                  ///< pattern area [m^2]
};

MembraneStencil membrane_stencil(const ClothMesh& mesh, int triangle);

/// Columns are the corners' positions.
using TrianglePositions = Eigen::Matrix3d;
using TriangleGradient = Eigen::Matrix<double, 9, 1>;  ///< corner by corner
using TriangleHessian = Eigen::Matrix<double, 9, 9>;

double membrane_energy(const MembraneStencil& stencil, const MembraneStiffness& stiffness, const TrianglePositions& x);
TriangleGradient membrane_gradient(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                   const TrianglePositions& x);
TriangleHessian membrane_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                 const TrianglePositions& x);
/// Positive semidefinite: the second Piola-Kirchhoff stress in the geometric term loses its compressive part. Of a
/// tension field it is the true Hessian.
TriangleHessian membrane_projected_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                           const TrianglePositions& x);
/// What the projection takes from the geometric term: the 3x3 blocks of the true Hessian, less those of the projected
/// one, are these numbers, by corner and corner, times the identity. (The squeeze stays projected.)
Eigen::Matrix3d membrane_softening(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                   const TrianglePositions& x);

}  // namespace toile
