#pragma once

#include <Eigen/Core>
#include <vector>

#include "evaluate/strain_rest.h"

namespace toile::evaluate {

/// How one triangle is deformed: x = F X + c takes its rest plane to its place in space.
///
/// F (3 x 2, in the rest triangle's frame) comes from the edge vectors, F = R U is its polar decomposition, from a
/// singular value decomposition: so no root is taken of an eigenvalue of F^T F, which rounding may leave negative. R
/// has orthonormal columns, U = R^T F is symmetric.
struct TriangleStrain {
    StrainFault fault = StrainFault::none;
    Eigen::Matrix<double, 3, 2> gradient;        ///< F
    Eigen::Matrix<double, 3, 2> rotation;        ///< R
    Eigen::Vector2d stretch;                     ///< l1 >= l2 >= 0
    Eigen::Matrix<double, 3, 2> rest_direction;  ///< columns: unit, at rest (of a pattern: u, v, 0), for l1, l2
    Eigen::Matrix<double, 3, 2> direction;       ///< columns: unit, in space
    Eigen::Matrix3d surface_gradient;            ///< F with the rest normal taken to the normal, for the rates
};

/// Of all triangles `[F]`. `position` `[V x 3]`, finite. A triangle without values is NaN. Inversion has a meaning only
/// where both rest and deformed mesh are flat: elsewhere a triangle that is folded over is a fold. Triangles are shared
/// among `jobs` threads; each is worked out alone.
std::vector<TriangleStrain> triangle_strain(const StrainRest& rest, const Positions& position, int jobs);

}  // namespace toile::evaluate
