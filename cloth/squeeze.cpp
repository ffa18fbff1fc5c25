#include "cloth/squeeze.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace toile {
namespace {

/// Below this share of the larger one a length has no direction left.
constexpr double nothing = 1e-14;

/// The larger principal direction of the symmetric matrix [[a, c], [c, b]].
Eigen::Vector2d larger_direction(double a, double b, double c) {
    const double half = 0.5 * (a - b), radius = std::sqrt(half * half + c * c);
    if (!(radius > 0.0)) return Eigen::Vector2d::UnitX();
    // Of two equal expressions the one without cancellation.
    const Eigen::Vector2d direction =
        half >= 0.0 ? Eigen::Vector2d(half + radius, c) : Eigen::Vector2d(c, radius - half);
    return direction.normalized();
}

/// A unit vector at right angles to a unit vector.
Eigen::Vector3d some_normal(const Eigen::Vector3d& unit) {
    int smallest = 0;
    unit.cwiseAbs().minCoeff(&smallest);
    return unit.cross(Eigen::Vector3d::Unit(smallest)).normalized();
}

}  // namespace

bool Squeeze::acts(const Deformation& deformation) {
    constexpr double square = onset * onset;
    const Eigen::Vector3d fu = deformation.col(0), fv = deformation.col(1);
    const double a = fu.squaredNorm() - square, b = fv.squaredNorm() - square, c = fu.dot(fv);
    return !(a + b >= 0.0 && a * b >= c * c);
}

Squeeze::Squeeze(const Deformation& deformation, double beta) {
    const Eigen::Vector3d fu = deformation.col(0), fv = deformation.col(1), normal = fu.cross(fv);
    inner_.col(0) = larger_direction(fu.squaredNorm(), fv.squaredNorm(), fu.dot(fv));
    inner_.col(1) << -inner_(1, 0), inner_(0, 0);
    const Eigen::Vector3d longest = deformation * inner_.col(0);
    const double area = normal.norm();
    stretch_[0] = longest.norm();
    stretch_[1] = stretch_[0] > 0.0 ? area / stretch_[0] : 0.0;
    // A triangle that is a line or a point may open in any direction: it takes the same one each time.
    outer_.col(0) = stretch_[0] > 0.0 ? Eigen::Vector3d(longest / stretch_[0]) : Eigen::Vector3d::UnitX();
    outer_.col(2) =
        area > nothing * stretch_[0] * stretch_[0] ? Eigen::Vector3d(normal / area) : some_normal(outer_.col(0));
    outer_.col(1) = outer_.col(2).cross(outer_.col(0));
    energy_ = 0.0;
    for (int i = 0; i < 2; ++i) {
        const double below = std::max(0.0, onset - stretch_[i]);
        energy_ += beta / 6.0 * below * below * below;
        slope_[i] = -0.5 * beta * below * below;
        curve_[i] = beta * below;
    }
}

Deformation Squeeze::stress() const {
    return slope_[0] * outer_.col(0) * inner_.col(0).transpose() +
           slope_[1] * outer_.col(1) * inner_.col(1).transpose();
}

void Squeeze::add_hessian(const Deformation& corner_gradient, double area, bool projected,
                          Eigen::Matrix<double, 9, 9>& hessian) const {
    const Eigen::Matrix<double, 3, 2> principal = corner_gradient * inner_;  // corners' gradients along each direction
    const auto add_mode = [&](double value, const Eigen::Matrix3d& corners) {
        if (value == 0.0 || (projected && value < 0.0)) return;
        const Eigen::Map<const Eigen::Matrix<double, 9, 1>> mode(corners.data());
        hessian.noalias() += (area * value) * mode * mode.transpose();
    };
    const Eigen::Matrix3d along[2] = {outer_.col(0) * principal.col(0).transpose(),
                                      outer_.col(1) * principal.col(1).transpose()};
    const Eigen::Matrix3d across[2] = {outer_.col(0) * principal.col(1).transpose(),
                                       outer_.col(1) * principal.col(0).transpose()};
    for (int i = 0; i < 2; ++i) add_mode(curve_[i], along[i]);
    const double apart = stretch_[0] - stretch_[1];
    const double shear = apart > 1e-9 ? (slope_[0] - slope_[1]) / apart : curve_[1];
    add_mode(0.5 * shear, across[0] + across[1]);
    if (projected) return;  // slopes are not positive, so all others bend down
    const double sum = std::max(stretch_[0] + stretch_[1], nothing);
    add_mode(0.5 * (slope_[0] + slope_[1]) / sum, across[0] - across[1]);
    for (int i = 0; i < 2; ++i)
        add_mode(slope_[i] / std::max(stretch_[i], nothing), outer_.col(2) * principal.col(i).transpose());
}

}  // namespace toile
