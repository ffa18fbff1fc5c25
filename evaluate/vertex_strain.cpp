#include "evaluate/vertex_strain.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "cloth/topology.h"
#include "evaluate/strain_blocks.h"

namespace toile::evaluate {
namespace {

constexpr double smallest_rank = 1e-7;  // singular value of the correspondences, of the largest
constexpr double collapsed_stretch = 1e-10;

bool is_unit(const Eigen::RowVector3d& normal) {
    return std::abs(normal.squaredNorm() - 1) < 0.5;
}

void clear(VertexStrain& strain) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    strain.gradient.setConstant(nan);
    strain.rotation.coeffs().setConstant(nan);
    strain.stretch.setConstant(nan);
    strain.rest_direction.setConstant(nan);
    strain.direction.setConstant(nan);
    strain.surface_stretch.setConstant(nan);
    strain.residual = nan;
}

bool is_finite(const VertexStrain& strain) {
    return strain.gradient.allFinite() && strain.stretch.allFinite() && strain.rotation.coeffs().allFinite() &&
           strain.direction.allFinite() && strain.rest_direction.allFinite() && strain.surface_stretch.allFinite() &&
           std::isfinite(strain.residual);
}

void decompose(const Eigen::Vector3d& rest_normal, VertexStrain& strain) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(strain.gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
    strain.stretch = svd.singularValues();
    strain.rest_direction = svd.matrixV();
    strain.direction = svd.matrixU();
    for (int k = 0; k < 3; ++k) {
        Eigen::Index largest = 0;
        strain.rest_direction.col(k).cwiseAbs().maxCoeff(&largest);
        if (strain.rest_direction(largest, k) > 0) continue;
        strain.rest_direction.col(k) *= -1;
        strain.direction.col(k) *= -1;
    }
    Eigen::Matrix<double, 3, 2> tangent;
    tangent.col(0) = rest_normal.unitOrthogonal();
    tangent.col(1) = rest_normal.cross(tangent.col(0));
    const Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>> surface(strain.gradient * tangent);
    if (surface.info() == Eigen::Success) strain.surface_stretch = surface.singularValues();
}

Eigen::Quaterniond kabsch(const Eigen::Matrix3d& correlation) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d left = svd.matrixU();
    if ((left * svd.matrixV().transpose()).determinant() < 0) left.col(2) *= -1;
    Eigen::Quaterniond rotation(Eigen::Matrix3d(left * svd.matrixV().transpose()));
    if (rotation.w() < 0) rotation.coeffs() *= -1;
    return rotation;
}

}  // namespace

VertexStrainFit::VertexStrainFit(const StrainRest& rest, const Neighbourhoods& neighbourhoods, double normal_weight,
                                 int jobs)
    : rest_(rest),
      around_(neighbourhoods),
      normal_weight_(normal_weight),
      vertex_(static_cast<size_t>(rest.vertex_count)),
      weights_(Positions::Zero(static_cast<Eigen::Index>(neighbourhoods.point.size()), 3)) {
    for_blocks(rest.vertex_count, jobs, [this](int v) { prepare(v); });
}

/// The rows of the pseudo-inverse of the correspondences' rest sides [p; sqrt(w m) s N].
void VertexStrainFit::prepare(int v) {
    const int first = around_.offset[v], count = around_.offset[v + 1] - first;
    Vertex& out = vertex_[v];
    out.normal_weights.setZero();
    if (count < 3) {
        out.fault = StrainFault::too_few;
        return;
    }
    const Eigen::RowVector3d normal = rest_.normal.row(around_.centre[v]);
    if (!is_unit(normal)) {
        out.fault = StrainFault::no_normal;
        return;
    }
    Eigen::MatrixXd design(count + 1, 3);
    for (int j = 0; j < count; ++j) design.row(j) = rest_.point.row(around_.point[first + j]);
    const Eigen::RowVector3d centroid = design.topRows(count).colwise().mean();
    design.topRows(count).rowwise() -= centroid;
    out.scale = normal_weight_ * design.topRows(count).squaredNorm();
    design.row(count) = std::sqrt(out.scale) * normal;
    if (!design.allFinite()) {
        out.fault = StrainFault::overflow;
        return;
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(design, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::Vector3d value = svd.singularValues();
    if (!(value[2] > smallest_rank * value[0])) {
        out.fault = StrainFault::low_rank;
        return;
    }
    const Eigen::MatrixXd inverse = svd.matrixU() * value.cwiseInverse().asDiagonal() * svd.matrixV().transpose();
    weights_.middleRows(first, count) = inverse.topRows(count);
    out.normal_weights = std::sqrt(out.scale) * inverse.row(count);
    if (!inverse.allFinite()) out.fault = StrainFault::overflow;
}

/// F, the correlation of Kabsch's rotation, and how well F explains the neighbourhood.
Eigen::Matrix3d VertexStrainFit::fit_gradient(int v, const Positions& point, const Eigen::Vector3d& normal,
                                              VertexStrain& strain) const {
    const int first = around_.offset[v], count = around_.offset[v + 1] - first;
    Eigen::RowVector3d rest_centroid = Eigen::RowVector3d::Zero(), centroid = Eigen::RowVector3d::Zero();
    for (int j = first; j < first + count; ++j) {
        rest_centroid += rest_.point.row(around_.point[j]) / count;
        centroid += point.row(around_.point[j]) / count;
    }
    Eigen::Matrix3d gradient = normal * vertex_[v].normal_weights;
    Eigen::Matrix3d correlation = vertex_[v].scale * normal * rest_.normal.row(around_.centre[v]);
    for (int j = first; j < first + count; ++j) {
        const Eigen::Vector3d q = point.row(around_.point[j]) - centroid;
        gradient += q * weights_.row(j);
        correlation += q * (rest_.point.row(around_.point[j]) - rest_centroid);
    }
    double missed = 0, size = 0;
    for (int j = first; j < first + count; ++j) {
        const Eigen::Vector3d q = point.row(around_.point[j]) - centroid;
        missed += (gradient * (rest_.point.row(around_.point[j]) - rest_centroid).transpose() - q).squaredNorm();
        size += q.squaredNorm();
    }
    strain.gradient = gradient;
    strain.residual = size > 0 ? std::sqrt(missed / size) : 0;
    return correlation;
}

VertexStrain VertexStrainFit::fit_vertex(int v, const Positions& point, const Positions& normal) const {
    VertexStrain strain;
    clear(strain);
    strain.fault = vertex_[v].fault;
    if (!has_strain(strain.fault)) return strain;
    const int centre = around_.centre[v];
    if (normal_weight_ > 0 && !is_unit(normal.row(centre))) {
        strain.fault = StrainFault::no_normal;
        return strain;
    }
    const Eigen::RowVector3d turned =
        normal_weight_ > 0 ? Eigen::RowVector3d(normal.row(centre)) : Eigen::RowVector3d(0, 0, 0);
    const Eigen::Matrix3d correlation = fit_gradient(v, point, turned.transpose(), strain);
    if (strain.gradient.allFinite() && correlation.allFinite()) {
        decompose(rest_.normal.row(centre), strain);
        strain.rotation = kabsch(correlation);
    }
    if (!is_finite(strain)) {
        clear(strain);
        strain.fault = StrainFault::overflow;
    } else if (strain.stretch[2] <= collapsed_stretch * strain.stretch[0]) {
        strain.fault = StrainFault::collapsed;
    } else if (strain.gradient.determinant() < 0) {
        strain.fault = StrainFault::inverted;
    }
    return strain;
}

std::vector<VertexStrain> VertexStrainFit::fit(const Positions& position, int jobs) const {
    const Positions point = point_positions(rest_, position);
    const Positions normal = vertex_normals(rest_.triangle, point);
    std::vector<VertexStrain> strain(vertex_.size());
    for_blocks(static_cast<int>(strain.size()), jobs, [&](int v) { strain[v] = fit_vertex(v, point, normal); });
    return strain;
}

}  // namespace toile::evaluate
