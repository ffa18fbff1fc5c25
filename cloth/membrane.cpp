#include "cloth/membrane.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace toile {
namespace {

struct Strain {
    Eigen::Matrix<double, 3, 2> deformation;  // F
    Eigen::Vector3d green;                    // ε_uu, ε_vv, 2 ε_uv
    Eigen::Vector3d stress;                   // second Piola-Kirchhoff: S_uu, S_vv, S_uv
};

Eigen::Matrix3d stiffness_matrix(const MembraneStiffness& c) {
    Eigen::Matrix3d matrix;
    matrix << c.uu, c.uv, 0, c.uv, c.vv, 0, 0, 0, c.shear;
    return matrix;
}

Strain strain_of(const MembraneStencil& stencil, const MembraneStiffness& c, const TrianglePositions& x) {
    Strain s;
    s.deformation = x * stencil.corner_gradient;
    const Eigen::Vector3d fu = s.deformation.col(0), fv = s.deformation.col(1);
    s.green << 0.5 * (fu.squaredNorm() - 1.0), 0.5 * (fv.squaredNorm() - 1.0), fu.dot(fv);
    s.stress << c.uu * s.green[0] + c.uv * s.green[1], c.uv * s.green[0] + c.vv * s.green[1], c.shear * s.green[2];
    return s;
}

/// The positive semidefinite part of the symmetric matrix (a, b, c) = [[a, c], [c, b]].
Eigen::Matrix2d positive_part(double a, double b, double c) {
    const double mean = 0.5 * (a + b), radius = std::hypot(0.5 * (a - b), c);
    Eigen::Matrix2d matrix;
    matrix << a, c, c, b;
    if (mean - radius >= 0.0) return matrix;
    if (mean + radius <= 0.0) return Eigen::Matrix2d::Zero();
    // One eigenvalue of each sign: keep λ₊ times the projector (A − λ₋ I) / (λ₊ − λ₋).
    return (mean + radius) / (2.0 * radius) * (matrix - (mean - radius) * Eigen::Matrix2d::Identity());
}

TriangleHessian hessian_with_geometric_stress(const MembraneStencil& stencil, const MembraneStiffness& c,
                                              const Strain& s, const Eigen::Matrix2d& geometric_stress) {
    // B maps corner motions to strain rates (ε_uu, ε_vv, 2 ε_uv).
    Eigen::Matrix<double, 3, 9> strain_rate;
    const Eigen::RowVector3d fu = s.deformation.col(0).transpose(), fv = s.deformation.col(1).transpose();
    for (int i = 0; i < 3; ++i) {
        const double gu = stencil.corner_gradient(i, 0), gv = stencil.corner_gradient(i, 1);
        strain_rate.block<1, 3>(0, 3 * i) = gu * fu;
        strain_rate.block<1, 3>(1, 3 * i) = gv * fv;
        strain_rate.block<1, 3>(2, 3 * i) = gu * fv + gv * fu;
    }
    TriangleHessian hessian = strain_rate.transpose() * (stiffness_matrix(c) * strain_rate);
    const Eigen::Matrix3d geometric = stencil.corner_gradient * geometric_stress * stencil.corner_gradient.transpose();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int axis = 0; axis < 3; ++axis) hessian(3 * i + axis, 3 * j + axis) += geometric(i, j);
    return stencil.area * hessian;
}

}  // namespace

MembraneStiffness MembraneStiffness::from_moduli(double weft, double warp, double shear, double poisson_ratio) {
    const double scale = 1.0 / (1.0 - poisson_ratio * poisson_ratio);
    return {weft * scale, warp * scale, poisson_ratio * std::sqrt(weft * warp) * scale, shear};
}

MembraneStencil membrane_stencil(const ClothMesh& mesh, int triangle) {
    const auto p = mesh.pattern_triangle.row(triangle);
    const Eigen::Vector2d origin = mesh.pattern_position.row(p[0]).transpose();
    Eigen::Matrix2d sides;
    sides.col(0) = mesh.pattern_position.row(p[1]).transpose() - origin;
    sides.col(1) = mesh.pattern_position.row(p[2]).transpose() - origin;
    MembraneStencil stencil;
    stencil.area = 0.5 * std::abs(sides.determinant());
    const Eigen::Matrix2d inverse = sides.inverse();
    stencil.corner_gradient.row(1) = inverse.row(0);
    stencil.corner_gradient.row(2) = inverse.row(1);
    stencil.corner_gradient.row(0) = -inverse.row(0) - inverse.row(1);
    return stencil;
}

double membrane_energy(const MembraneStencil& stencil, const MembraneStiffness& stiffness, const TrianglePositions& x) {
    const Strain s = strain_of(stencil, stiffness, x);
    return 0.5 * stencil.area * s.green.dot(s.stress);
}

TriangleGradient membrane_gradient(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                   const TrianglePositions& x) {
    const Strain s = strain_of(stencil, stiffness, x);
    Eigen::Matrix2d stress;
    stress << s.stress[0], s.stress[2], s.stress[2], s.stress[1];
    TriangleGradient gradient;
    Eigen::Map<Eigen::Matrix3d>(gradient.data()) =
        stencil.area * s.deformation * stress * stencil.corner_gradient.transpose();
    return gradient;
}

TriangleHessian membrane_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                 const TrianglePositions& x) {
    const Strain s = strain_of(stencil, stiffness, x);
    Eigen::Matrix2d stress;
    stress << s.stress[0], s.stress[2], s.stress[2], s.stress[1];
    return hessian_with_geometric_stress(stencil, stiffness, s, stress);
}

TriangleHessian membrane_projected_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                           const TrianglePositions& x) {
    const Strain s = strain_of(stencil, stiffness, x);
    return hessian_with_geometric_stress(stencil, stiffness, s, positive_part(s.stress[0], s.stress[1], s.stress[2]));
}

}  // namespace toile
