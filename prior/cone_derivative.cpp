#include "prior/cone_derivative.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile::prior {
namespace {

constexpr double kWeak = 1e-8;  // relative length and force below which an edge counts as weakly active
// Shifts in units of the mean stiffness. Along multipliers (1, −n), the size against which a redundancy is told from a
// mere poor condition; across them, where S has full rank and the iteration makes good for any shift, and along ψ ~
// (1, −n), which no right-hand side reaches, larger ones, so that pivots lose few digits.
constexpr double kShift = 1e-5, kShiftAcross = 1e-3, kShiftUnreached = 1.0;
constexpr double kSolved = 1e-14;  // relative residual
constexpr double kTrusted = 1e-8;  // relative residual up to which a derivative counts as converged
constexpr int kMaxIterations = 100;

using ConstPoints = Eigen::Map<const Positions>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;

ConstVector view(std::span<const double> values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

Eigen::Vector3d edge_vector(const InextensibilityModel& model, const ConstPoints& r, int e) {
    return (r.row(model.edge(e, 0)) - r.row(model.edge(e, 1))).transpose();
}

}  // namespace

TautEdges find_taut_edges(const InextensibilityModel& model, std::span<const double> position,
                          std::span<const double> multiplier) {
    const ConstPoints r(position.data(), model.vertex_count, 3);
    const int edges = static_cast<int>(model.edge.rows());
    TautEdges taut;
    const double largest = edges > 0 ? view(multiplier).maxCoeff() : 0.0;
    for (int e = 0; e < edges; ++e) {
        const double length = edge_vector(model, r, e).norm(), limit = model.edge_max_length[e];
        const double k_a = model.target_stiffness[model.edge(e, 0)], k_b = model.target_stiffness[model.edge(e, 1)];
        const double force = largest > 0.0 ? multiplier[e] / largest : 0.0;
        const double clear = std::max(force, 1.0 - length / limit);
        if (clear <= kWeak) {
            ++taut.weakly_active;
        } else if (force > kWeak && multiplier[e] > k_a / (k_a + k_b) * k_b * (limit - length)) {
            taut.edge.push_back(e);
        }
        taut.distance = std::min(taut.distance, std::max(clear, 0.0));
    }
    return taut;
}

ConeDerivative::ConeDerivative(const InextensibilityModel& model, std::span<const double> position,
                               std::span<const double> multiplier)
    : model_(model),
      stiffness_unit_(model.target_stiffness.mean()),
      taut_(find_taut_edges(model, position, multiplier)) {
    assemble(model, position, multiplier);
}

void ConeDerivative::assemble(const InextensibilityModel& model, std::span<const double> position,
                              std::span<const double> multiplier) {
    // In units of the mean stiffness; ψ_e is scaled by l_e^max, so that S_e = [1 nᵀ ; n I] and ZS_e = λ_e/l_e^max (…).
    const ConstPoints r(position.data(), model.vertex_count, 3);
    const int coordinates = 3 * model.vertex_count, size = coordinates + 8 * static_cast<int>(taut_.edge.size());
    std::vector<Eigen::Triplet<double>> entry, shift;
    entry.reserve(static_cast<size_t>(coordinates) + 30 * taut_.edge.size());
    for (int i = 0; i < coordinates; ++i) entry.emplace_back(i, i, model.target_stiffness[i / 3] / stiffness_unit_);
    for (size_t j = 0; j < taut_.edge.size(); ++j) {
        const int e = taut_.edge[j], z = coordinates + 8 * static_cast<int>(j), psi = z + 4;
        const Eigen::Vector3d n = edge_vector(model, r, e).normalized();
        const double stiffness = multiplier[e] / model.edge_max_length[e] / stiffness_unit_;
        for (int c = 0; c < 3; ++c) {
            entry.emplace_back(z + 1 + c, 3 * model.edge(e, 0) + c, -1.0);  // G_e
            entry.emplace_back(z + 1 + c, 3 * model.edge(e, 1) + c, 1.0);
            entry.emplace_back(psi, z + 1 + c, n[c]);  // S_e
            entry.emplace_back(psi + 1 + c, z, n[c]);
            for (int d = 0; d <= c; ++d)  // ZS_e
                entry.emplace_back(psi + 1 + c, psi + 1 + d, stiffness * ((c == d ? 1.0 : 0.0) - n[c] * n[d]));
        }
        Eigen::Vector4d pull;
        pull << 1.0, -n;
        const Eigen::Matrix4d along = 0.5 * pull * pull.transpose(), across = Eigen::Matrix4d::Identity() - along;
        for (int c = 0; c < 4; ++c) {
            entry.emplace_back(psi + c, z + c, 1.0);
            for (int d = 0; d <= c; ++d) {
                shift.emplace_back(z + c, z + d, -kShift * along(c, d) - kShiftAcross * across(c, d));
                shift.emplace_back(psi + c, psi + d, kShiftUnreached * along(c, d) + kShiftAcross * across(c, d));
            }
        }
    }
    matrix_.resize(size, size);
    matrix_.setFromTriplets(entry.begin(), entry.end());
    entry.insert(entry.end(), shift.begin(), shift.end());
    shifted_.resize(size, size);
    shifted_.setFromTriplets(entry.begin(), entry.end());
}

double ConeDerivative::solve(bool inconsistent) {
    solution_.setZero(right_.size());
    const double size = right_.size() > 0 ? right_.cwiseAbs().maxCoeff() : 0.0;
    if (!(size > 0.0)) return 0.0;
    QuasidefiniteLdl ldl(shifted_);
    if (!ldl.factor(shifted_)) return std::numeric_limits<double>::infinity();
    const auto matrix = matrix_.selfadjointView<Eigen::Lower>();
    double error = 1.0;
    residual_ = right_;
    for (int k = 0; k < kMaxIterations && error > kSolved; ++k) {
        ldl.solve(residual_, correction_);
        solution_ += correction_;
        residual_ = right_;
        residual_.noalias() -= matrix * solution_;
        const double last = error;
        // What the range of the matrix cannot express is orthogonal to it, so a product with the matrix leaves it out.
        if (inconsistent)
            error = (matrix * residual_).cwiseAbs().maxCoeff() / size;
        else
            error = residual_.cwiseAbs().maxCoeff() / size;
        if (!(error < last)) break;
    }
    return error;
}

DerivativeReport ConeDerivative::report_of(double residual) const {
    DerivativeReport report;
    report.linear_residual = residual;
    report.status = residual <= kTrusted ? Status::converged : Status::accuracy_not_reached;
    report.taut_edges = static_cast<int>(taut_.edge.size());
    report.weakly_active = taut_.weakly_active;
    report.active_set_distance = taut_.distance;
    return report;
}

DerivativeReport ConeDerivative::backward(std::span<const double> loss_gradient, std::span<double> predicted_gradient,
                                          std::span<double> edge_max_length_gradient) {
    const Eigen::Index coordinates = 3 * model_.vertex_count;
    right_.setZero(matrix_.rows());
    right_.head(coordinates) = view(loss_gradient);
    const double residual = solve(false);
    for (Eigen::Index i = 0; i < coordinates; ++i)
        predicted_gradient[static_cast<size_t>(i)] = model_.target_stiffness[i / 3] / stiffness_unit_ * solution_[i];
    std::fill(edge_max_length_gradient.begin(), edge_max_length_gradient.end(), 0.0);
    for (size_t j = 0; j < taut_.edge.size(); ++j)
        edge_max_length_gradient[static_cast<size_t>(taut_.edge[j])] =
            solution_[coordinates + 8 * static_cast<Eigen::Index>(j)];
    return report_of(residual);
}

DerivativeReport ConeDerivative::tangent(std::span<const double> predicted_change,
                                         std::span<const double> edge_max_length_change,
                                         std::span<double> position_change) {
    const Eigen::Index coordinates = 3 * model_.vertex_count;
    right_.setZero(matrix_.rows());
    for (Eigen::Index i = 0; i < coordinates; ++i)
        right_[i] = model_.target_stiffness[i / 3] / stiffness_unit_ * predicted_change[static_cast<size_t>(i)];
    if (!edge_max_length_change.empty())
        for (size_t j = 0; j < taut_.edge.size(); ++j)
            right_[coordinates + 8 * static_cast<Eigen::Index>(j)] =
                edge_max_length_change[static_cast<size_t>(taut_.edge[j])];
    const double residual = solve(!edge_max_length_change.empty());
    Eigen::Map<Eigen::VectorXd>(position_change.data(), coordinates) = solution_.head(coordinates);
    return report_of(residual);
}

}  // namespace toile::prior
