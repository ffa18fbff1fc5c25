#pragma once

#include <Eigen/Core>

#include "cloth/cloth_mesh.h"

namespace toile {

/// Hinge bending of a cloth whose rest state is flat: the quadratic form of isometric bending (Bergou et al. 2006, "A
/// quadratic bending model for inextensible surfaces"). For the hinge with shared edge (a, b) and opposite vertices (c,
/// d)
///
///     E = ½ k / (A_0 + A_1) · |Σ_i w_i x_i|²,     |Σ_i w_i x_i| = 2 |e| sin(θ/2) as long as lengths are kept,
///
/// with w of cotangents of the pattern triangles. Its Hessian is constant and positive semidefinite, and it knows no
/// jump at a folded hinge.
///
/// k [N m] is the cloth's bending rigidity: a cylinder of curvature κ costs ½ k κ² per area on a mesh of equilateral
/// triangles, however it lies. (Bergou's factor is 3 / (A_0 + A_1), the mean curvature squared over a hinge's third of
/// its triangles; but of a cylinder's three families of hinges only one folds as much as that.) Meshes of right
/// triangles are as exact along their short sides, and up to three times too stiff along their long ones.
struct BendingStencil {
    Eigen::Vector4d weight;  ///< w, for (a, b, c, d)
    double scale;            ///< 1 / (A_0 + A_1) [1/m^2]
};

/// Stencil of the hinge (a, b, c, d) between the triangles `first` (with c) and `second` (with d), from their pattern
/// shapes.
BendingStencil bending_stencil(const ClothMesh& mesh, const Eigen::Vector4i& hinge, int first, int second);

/// Columns are the positions of a, b, c, d.
using HingePositions = Eigen::Matrix<double, 3, 4>;

double bending_energy(const BendingStencil& stencil, double stiffness, const HingePositions& x);
Eigen::Matrix<double, 12, 1> bending_gradient(const BendingStencil& stencil, double stiffness, const HingePositions& x);
/// Constant, one number for each pair of vertices: the Hessian is this matrix times the 3x3 identity.
Eigen::Matrix4d bending_hessian(const BendingStencil& stencil, double stiffness);

}  // namespace toile
