#include "evaluate/strain_columns.h"

#include <cstdint>

namespace toile::evaluate {
namespace {

/// Row by row, whatever the matrix' own order.
template <typename Matrix>
void append(std::vector<double>& column, const Matrix& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
        for (Eigen::Index k = 0; k < matrix.cols(); ++k) column.push_back(matrix(row, k));
}

}  // namespace

files::StrainColumns strain_columns(const std::vector<TriangleStrain>& strain, bool stretches_only) {
    files::StrainColumns out;
    for (const TriangleStrain& one : strain) {
        out.fault.push_back(static_cast<std::int8_t>(one.fault));
        append(out.stretch, one.stretch);
        if (stretches_only) continue;
        append(out.gradient, one.gradient);
        append(out.rotation, one.rotation);
        append(out.rest_direction, one.rest_direction.transpose());
        append(out.direction, one.direction.transpose());
    }
    return out;
}

files::StrainColumns strain_columns(const std::vector<VertexStrain>& strain, bool stretches_only) {
    files::StrainColumns out;
    for (const VertexStrain& one : strain) {
        out.fault.push_back(static_cast<std::int8_t>(one.fault));
        append(out.stretch, one.stretch);
        append(out.surface_stretch, one.surface_stretch);
        out.residual.push_back(one.residual);
        if (stretches_only) continue;
        append(out.gradient, one.gradient);
        const Eigen::Quaterniond& q = one.rotation;
        out.rotation.insert(out.rotation.end(), {q.w(), q.x(), q.y(), q.z()});
        append(out.rest_direction, one.rest_direction.transpose());
        append(out.direction, one.direction.transpose());
    }
    return out;
}

files::RateColumns rate_columns(const std::vector<StrainRate>& rates, bool stretches_only) {
    files::RateColumns out;
    for (const StrainRate& one : rates) {
        append(out.strain_rate, one.rate);
        append(out.spin, one.spin);
        out.rate_error.push_back(one.error);
        if (!stretches_only) append(out.velocity_gradient, one.velocity_gradient);
    }
    return out;
}

}  // namespace toile::evaluate
