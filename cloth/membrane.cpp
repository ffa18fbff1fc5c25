#include "cloth/membrane.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cloth/squeeze.h"
#include "cloth/tension_field.h"

namespace toile {
namespace {

/// What a triangle's strain answers, per unit of pattern area.
struct Response {
    Deformation deformation;  // F
    double energy;
    Eigen::Vector3d stress;   // second Piola-Kirchhoff: S_uu, S_vv, S_uv, without the squeeze
    Eigen::Matrix3d tangent;  // ∂S/∂(ε_uu, ε_vv, 2 ε_uv); set where it was asked for
    bool squeezed;
};

Response respond(const MembraneStencil& stencil, const MembraneStiffness& c, const TrianglePositions& x,
                 bool with_tangent) {
    Response r;
    // The corners' gradients add up to zero, so differences will do.
    const Eigen::Vector3d first = x.col(1) - x.col(0), second = x.col(2) - x.col(0);
    const auto& g = stencil.corner_gradient;
    r.deformation.col(0) = g(1, 0) * first + g(2, 0) * second;
    r.deformation.col(1) = g(1, 1) * first + g(2, 1) * second;
    const Eigen::Vector3d fu = r.deformation.col(0), fv = r.deformation.col(1);
    const Eigen::Vector3d green(0.5 * (fu.squaredNorm() - 1.0), 0.5 * (fv.squaredNorm() - 1.0), fu.dot(fv));
    if (c.compression == Compression::tension_field) {
        const TensionField field = tension_field(c, green);
        r.energy = field.energy;
        r.stress = field.stress;
        r.tangent = field.tangent;
        r.squeezed = false;
        return r;
    }
    r.stress << c.uu * green[0] + c.uv * green[1], c.uv * green[0] + c.vv * green[1], c.shear * green[2];
    r.energy = 0.5 * green.dot(r.stress);
    if (with_tangent) r.tangent << c.uu, c.uv, 0, c.uv, c.vv, 0, 0, 0, c.shear;
    r.squeezed = Squeeze::acts(r.deformation);
    return r;
}

Squeeze squeeze_of(const Response& r, const MembraneStiffness& c) {
    return Squeeze(r.deformation, Squeeze::ratio * std::max(c.uu, c.vv));
}

/// The positive semidefinite part of the symmetric matrix (a, b, c) = [[a, c], [c, b]], in the same order.
Eigen::Vector3d positive_part(const Eigen::Vector3d& s) {
    const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
    const double radius = std::sqrt(half * half + s[2] * s[2]);
    if (mean - radius >= 0.0) return s;
    if (mean + radius <= 0.0) return Eigen::Vector3d::Zero();
    // One eigenvalue of each sign: keep λ₊ times the projector (A − λ₋ I) / (λ₊ − λ₋).
    const double share = (mean + radius) / (2.0 * radius), lower = mean - radius;
    return {share * (s[0] - lower), share * (s[1] - lower), share * s[2]};
}

/// area (Bᵀ T B + geometric stress), where B maps corner motions to rates of (ε_uu, ε_vv, 2 ε_uv): a sum of the four
/// outer products of f_u and f_v, one factor for each pair of corners.
TriangleHessian assemble(const MembraneStencil& stencil, const Response& r, const Eigen::Vector3d& stress) {
    const Eigen::Vector3d fu = r.deformation.col(0), fv = r.deformation.col(1);
    const Eigen::Matrix3d uu = fu * fu.transpose(), vv = fv * fv.transpose(), uv = fu * fv.transpose();
    TriangleHessian hessian;
    for (int i = 0; i < 3; ++i) {
        const double ui = stencil.area * stencil.corner_gradient(i, 0),
                     vi = stencil.area * stencil.corner_gradient(i, 1);
        const Eigen::RowVector3d from_u = ui * r.tangent.row(0) + vi * r.tangent.row(2);
        const Eigen::RowVector3d from_v = vi * r.tangent.row(1) + ui * r.tangent.row(2);
        for (int j = 0; j <= i; ++j) {
            const double uj = stencil.corner_gradient(j, 0), vj = stencil.corner_gradient(j, 1);
            const double on_uu = from_u[0] * uj + from_u[2] * vj, on_uv = from_u[1] * vj + from_u[2] * uj;
            const double on_vu = from_v[0] * uj + from_v[2] * vj, on_vv = from_v[1] * vj + from_v[2] * uj;
            const double geometric = ui * (stress[0] * uj + stress[2] * vj) + vi * (stress[2] * uj + stress[1] * vj);
            Eigen::Matrix3d block = on_uu * uu + on_vv * vv + on_uv * uv + on_vu * uv.transpose();
            block.diagonal().array() += geometric;
            hessian.block<3, 3>(3 * i, 3 * j) = block;
            if (i != j) hessian.block<3, 3>(3 * j, 3 * i) = block.transpose();
        }
    }
    return hessian;
}

}  // namespace

MembraneStiffness MembraneStiffness::from_moduli(double weft, double warp, double shear, double poisson_ratio,
                                                 Compression compression) {
    const double scale = 1.0 / (1.0 - poisson_ratio * poisson_ratio);
    return {weft * scale, warp * scale, poisson_ratio * std::sqrt(weft * warp) * scale, shear, compression};
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
    const Response r = respond(stencil, stiffness, x, false);
    const double squeeze = r.squeezed ? squeeze_of(r, stiffness).energy() : 0.0;
    return stencil.area * (r.energy + squeeze);
}

TriangleGradient membrane_gradient(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                   const TrianglePositions& x) {
    const Response r = respond(stencil, stiffness, x, false);
    Deformation first_piola;  // F S
    first_piola.col(0) = r.stress[0] * r.deformation.col(0) + r.stress[2] * r.deformation.col(1);
    first_piola.col(1) = r.stress[2] * r.deformation.col(0) + r.stress[1] * r.deformation.col(1);
    if (r.squeezed) first_piola += squeeze_of(r, stiffness).stress();
    TriangleGradient gradient;
    for (int i = 1; i < 3; ++i)
        gradient.segment<3>(3 * i) = stencil.area * (stencil.corner_gradient(i, 0) * first_piola.col(0) +
                                                     stencil.corner_gradient(i, 1) * first_piola.col(1));
    gradient.segment<3>(0) = -gradient.segment<3>(3) - gradient.segment<3>(6);
    return gradient;
}

TriangleHessian membrane_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                 const TrianglePositions& x) {
    const Response r = respond(stencil, stiffness, x, true);
    TriangleHessian hessian = assemble(stencil, r, r.stress);
    if (r.squeezed) squeeze_of(r, stiffness).add_hessian(stencil.corner_gradient, stencil.area, false, hessian);
    return hessian;
}

TriangleHessian membrane_projected_hessian(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                           const TrianglePositions& x) {
    const Response r = respond(stencil, stiffness, x, true);
    TriangleHessian hessian = assemble(stencil, r, positive_part(r.stress));
    if (r.squeezed) squeeze_of(r, stiffness).add_hessian(stencil.corner_gradient, stencil.area, true, hessian);
    return hessian;
}

Eigen::Matrix3d membrane_softening(const MembraneStencil& stencil, const MembraneStiffness& stiffness,
                                   const TrianglePositions& x) {
    const Response r = respond(stencil, stiffness, x, false);
    const Eigen::Vector3d pressed = r.stress - positive_part(r.stress);
    const auto& g = stencil.corner_gradient;
    const Eigen::Vector3d along_u = pressed[0] * g.col(0) + pressed[2] * g.col(1);
    const Eigen::Vector3d along_v = pressed[2] * g.col(0) + pressed[1] * g.col(1);
    return stencil.area * (g.col(0) * along_u.transpose() + g.col(1) * along_v.transpose());
}

}  // namespace toile
