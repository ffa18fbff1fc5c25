#include "cloth/strain_limit.h"

#include <algorithm>

namespace toile {
namespace {

/// One axis of the pattern: its column of F, and how far that is beyond the limit.
struct Axis {
    Eigen::Vector3d column, unit, corner_gradient;
    double length, beyond;

    Axis(const MembraneStencil& stencil, const TrianglePositions& x, int axis, double limit)
        : column(x * stencil.corner_gradient.col(axis)),
          corner_gradient(stencil.corner_gradient.col(axis)),
          length(column.norm()),
          beyond(std::max(0.0, length - limit)) {
        unit = beyond > 0.0 ? Eigen::Vector3d(column / length) : Eigen::Vector3d::Zero();
    }
};

}  // namespace

double strain_limit_energy(const MembraneStencil& stencil, const StrainLimit& limit, const TrianglePositions& x) {
    double energy = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double beyond = Axis(stencil, x, axis, axis == 0 ? limit.u : limit.v).beyond;
        energy += stencil.area * limit.stiffness / 6.0 * beyond * beyond * beyond;
    }
    return energy;
}

TriangleGradient strain_limit_gradient(const MembraneStencil& stencil, const StrainLimit& limit,
                                       const TrianglePositions& x) {
    TriangleGradient gradient = TriangleGradient::Zero();
    for (int axis = 0; axis < 2; ++axis) {
        const Axis a(stencil, x, axis, axis == 0 ? limit.u : limit.v);
        const Eigen::Vector3d tension = 0.5 * stencil.area * limit.stiffness * a.beyond * a.beyond * a.unit;
        for (int i = 0; i < 3; ++i) gradient.segment<3>(3 * i) += a.corner_gradient[i] * tension;
    }
    return gradient;
}

TriangleHessian strain_limit_hessian(const MembraneStencil& stencil, const StrainLimit& limit,
                                     const TrianglePositions& x) {
    TriangleHessian hessian = TriangleHessian::Zero();
    for (int axis = 0; axis < 2; ++axis) {
        const Axis a(stencil, x, axis, axis == 0 ? limit.u : limit.v);
        if (!(a.beyond > 0.0)) continue;
        const Eigen::Matrix3d along = a.unit * a.unit.transpose();
        const Eigen::Matrix3d block = stencil.area * limit.stiffness * a.beyond *
                                      (along + 0.5 * a.beyond / a.length * (Eigen::Matrix3d::Identity() - along));
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                hessian.block<3, 3>(3 * i, 3 * j) += a.corner_gradient[i] * a.corner_gradient[j] * block;
    }
    return hessian;
}

bool strain_limit_acts(const MembraneStencil& stencil, const StrainLimit& limit, const TrianglePositions& x) {
    return (x * stencil.corner_gradient.col(0)).squaredNorm() > limit.u * limit.u ||
           (x * stencil.corner_gradient.col(1)).squaredNorm() > limit.v * limit.v;
}

}  // namespace toile
