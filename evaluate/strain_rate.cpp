#include "evaluate/strain_rate.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace toile::evaluate {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double smallest_volume = 1e-10;
using Terms = std::vector<RateStencil::Term>;

Terms central(int frame, int step) {
    return {{frame - step, -0.5 / step}, {frame + step, 0.5 / step}};
}

/// Second order, to the side of `step`'s sign.
Terms one_sided(int frame, int step) {
    return {{frame, -1.5 / step}, {frame + step, 2.0 / step}, {frame + 2 * step, -0.5 / step}};
}

Eigen::Matrix3d derivative(const Terms& terms, int first_frame, const std::vector<Eigen::Matrix3d>& gradient,
                           double time_step) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const RateStencil::Term& term : terms) sum += term.weight / time_step * gradient[term.frame - first_frame];
    return sum;
}

}  // namespace

RateStencil rate_stencil(int frame, int frame_count) {
    const int last = frame_count - 1;
    // Error terms: h^2/6 F''' of central differences, -h^2/3 F''' of those to one side.
    if (frame >= 2 && frame + 2 <= last) return {central(frame, 1), central(frame, 2), 1.0 / 3};
    if (frame >= 1 && frame + 1 <= last) {
        if (frame + 2 <= last) return {central(frame, 1), one_sided(frame, 1), 1.0 / 3};
        if (frame >= 2) return {central(frame, 1), one_sided(frame, -1), 1.0 / 3};
        return {central(frame, 1), {}, 0};
    }
    const int side = frame == 0 ? 1 : -1;
    if (frame_count == 2) return {{{frame, -1.0 * side}, {frame + side, 1.0 * side}}, {}, 0};
    if (frame_count < 5) return {one_sided(frame, side), {}, 0};
    return {one_sided(frame, side), one_sided(frame, 2 * side), 1.0 / 3};
}

StrainRate strain_rate(const RateStencil& stencil, int frame, int first_frame,
                       const std::vector<Eigen::Matrix3d>& gradient, const Eigen::Vector3d& normal, double time_step) {
    StrainRate out;
    out.velocity_gradient.setConstant(nan);
    out.rate.setConstant(nan);
    out.spin.setConstant(nan);
    out.error = nan;
    const Eigen::Matrix3d& now = gradient[frame - first_frame];
    const double size = now.norm();
    if (!(std::abs((now / size).determinant()) > smallest_volume)) return out;
    const Eigen::Matrix3d inverse = now.inverse();
    const Eigen::Matrix3d rate = derivative(stencil.rate, first_frame, gradient, time_step) * inverse;
    if (!rate.allFinite()) return out;
    out.velocity_gradient = rate;
    // Where the surface is now: its tangents are those at rest, taken along.
    Eigen::Matrix<double, 3, 2> tangent;
    const Eigen::Vector3d first = normal.unitOrthogonal();
    tangent.col(0) = (now * first).normalized();
    tangent.col(1) = now * normal.cross(first);
    tangent.col(1) = (tangent.col(1) - tangent.col(0) * tangent.col(0).dot(tangent.col(1))).normalized();
    const Eigen::Matrix2d surface = tangent.transpose() * (0.5 * (rate + rate.transpose())) * tangent;
    out.rate = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(surface, Eigen::EigenvaluesOnly).eigenvalues().reverse();
    const Eigen::Matrix3d skew = 0.5 * (rate - rate.transpose());
    out.spin << skew(2, 1), skew(0, 2), skew(1, 0);
    if (stencil.check.empty()) return out;
    const Eigen::Matrix3d check = derivative(stencil.check, first_frame, gradient, time_step) * inverse;
    out.error = stencil.error_share * (check - rate).norm();
    return out;
}

}  // namespace toile::evaluate
