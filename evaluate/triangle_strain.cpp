#include "evaluate/triangle_strain.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <limits>

#include "evaluate/strain_blocks.h"

namespace toile::evaluate {
namespace {

void clear(TriangleStrain& strain) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    strain.gradient.setConstant(nan);
    strain.rotation.setConstant(nan);
    strain.stretch.setConstant(nan);
    strain.rest_direction.setConstant(nan);
    strain.direction.setConstant(nan);
    strain.surface_gradient.setConstant(nan);
}

void decompose(const StrainRest::Triangle& rest, TriangleStrain& strain) {
    const Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>> svd(strain.gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (svd.info() != Eigen::Success) return;
    const Eigen::Matrix<double, 3, 2> left = svd.matrixU().leftCols<2>();
    strain.stretch = svd.singularValues();
    strain.rotation = left * svd.matrixV().transpose();
    strain.rest_direction = rest.axis * svd.matrixV();
    strain.direction = left;
    for (int k = 0; k < 2; ++k) {
        // A direction and its opposite are one: the largest component at rest is positive.
        Eigen::Index largest = 0;
        strain.rest_direction.col(k).cwiseAbs().maxCoeff(&largest);
        if (strain.rest_direction(largest, k) > 0) continue;
        strain.rest_direction.col(k) *= -1;
        strain.direction.col(k) *= -1;
    }
    const Eigen::Vector3d normal = strain.rotation.col(0).cross(strain.rotation.col(1));
    strain.surface_gradient =
        strain.gradient * rest.axis.transpose() + normal * rest.axis.col(0).cross(rest.axis.col(1)).transpose();
}

bool is_finite(const TriangleStrain& strain) {
    return strain.gradient.allFinite() && strain.stretch.allFinite() && strain.rotation.allFinite() &&
           strain.direction.allFinite() && strain.surface_gradient.allFinite();
}

TriangleStrain strain_of(const StrainRest& rest, const Positions& position, int f) {
    TriangleStrain strain;
    clear(strain);
    const StrainRest::Triangle& frame = rest.frame[f];
    strain.fault = frame.fault;
    if (!has_strain(strain.fault)) return strain;
    const Eigen::Vector3d a = position.row(rest.mesh_triangle(f, 0)), b = position.row(rest.mesh_triangle(f, 1)),
                          c = position.row(rest.mesh_triangle(f, 2));
    Eigen::Matrix<double, 3, 2> edge;
    edge << b - a, c - a;
    strain.gradient = edge * frame.inverse_edge;
    if (strain.gradient.allFinite()) decompose(frame, strain);
    if (!is_finite(strain)) {
        clear(strain);
        strain.fault = StrainFault::overflow;
    } else if (is_degenerate(a, b, c)) {
        strain.fault = StrainFault::collapsed;
    }
    return strain;
}

}  // namespace

std::vector<TriangleStrain> triangle_strain(const StrainRest& rest, const Positions& position, int jobs) {
    std::vector<TriangleStrain> strain(rest.frame.size());
    for_blocks(static_cast<int>(strain.size()), jobs, [&](int f) { strain[f] = strain_of(rest, position, f); });
    if (rest.orientation.empty()) return strain;
    const std::vector<double> orientation = flat_orientation(rest.mesh_triangle, position);
    for (size_t f = 0; f < orientation.size(); ++f)
        if (strain[f].fault == StrainFault::none && orientation[f] * rest.orientation[f] < 0)
            strain[f].fault = StrainFault::inverted;
    return strain;
}

}  // namespace toile::evaluate
