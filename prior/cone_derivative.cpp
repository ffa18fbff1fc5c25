#include "prior/cone_derivative.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace toile::prior {
namespace {

constexpr double kWeak = 1e-8;  // relative length and force below which an edge counts as weakly active
// Shifts, in units of the mean stiffness. Along multipliers (1, −n) a small one, lowered where it turns out that some
// combination of them is nearly redundant; across them, where S has full rank and the iteration makes good for any
// shift, and along ψ ~ (1, −n), which no right-hand side reaches, larger ones, so that pivots lose few digits.
constexpr double kShiftAlong = 1e-5, kShiftAcross = 1e-3, kShiftUnreached = 1.0;
constexpr double kLowerShift = 1e-2;
constexpr int kMaxFactorisations = 3;
constexpr double kSolved = 1e-14;    // relative residual
constexpr double kTrusted = 1e-8;    // relative residual up to which a derivative counts as converged
constexpr int kMaxIterations = 40;   // for each shift
constexpr double kConverged = 1e-9;  // relative residual beyond which the shift is not lowered

using ConstPoints = Eigen::Map<const Positions>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;

ConstVector view(std::span<const double> values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

Eigen::Vector3d edge_vector(const InextensibilityModel& model, const ConstPoints& r, int e) {
    return (r.row(model.edge(e, 0)) - r.row(model.edge(e, 1))).transpose();
}

using Triplets = std::vector<Eigen::Triplet<double>>;

/// S_e = [1 nᵀ ; n I] between z_e and ψ_e, and ZS_e = stiffness (0 ⊕ (I − n nᵀ)): ψ_e scaled by l_e^max.
void add_cone(int z, const Eigen::Vector3d& n, double stiffness, Triplets& matrix) {
    const int psi = z + 4;
    for (int c = 0; c < 4; ++c) matrix.emplace_back(psi + c, z + c, 1.0);
    for (int c = 0; c < 3; ++c) {
        matrix.emplace_back(psi, z + 1 + c, n[c]);
        matrix.emplace_back(psi + 1 + c, z, n[c]);
        for (int d = 0; d <= c; ++d)
            matrix.emplace_back(psi + 1 + c, psi + 1 + d, stiffness * ((c == d ? 1.0 : 0.0) - n[c] * n[d]));
    }
}

/// The shift that makes the system quasi-definite, for a cone whose ZS and surroundings are of the size `scale`.
void add_shift(int z, const Eigen::Vector3d& n, double scale, Triplets& along_multipliers, Triplets& across) {
    Eigen::Vector4d pull;
    pull << 1.0, -n;
    const Eigen::Matrix4d along = 0.5 * pull * pull.transpose(), rest = Eigen::Matrix4d::Identity() - along;
    for (int c = 0; c < 4; ++c)
        for (int d = 0; d <= c; ++d) {
            along_multipliers.emplace_back(z + c, z + d, along(c, d));
            across.emplace_back(z + c, z + d, -kShiftAcross / scale * rest(c, d));
            across.emplace_back(z + 4 + c, z + 4 + d,
                                scale * (kShiftUnreached * along(c, d) + kShiftAcross * rest(c, d)));
        }
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
        const double force = largest > 0.0 ? multiplier[e] / largest : 0.0, slack = 1.0 - length / limit;
        const double clear = std::max(force, slack);
        if (clear <= kWeak) {
            ++taut.weakly_active;
        } else if (force > slack) {
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
    assemble(position, multiplier);
}

void ConeDerivative::assemble(std::span<const double> position, std::span<const double> multiplier) {
    const ConstPoints r(position.data(), model_.vertex_count, 3);
    const int coordinates = 3 * model_.vertex_count, size = coordinates + 8 * static_cast<int>(taut_.edge.size());
    Triplets matrix, along, across;
    for (int i = 0; i < coordinates; ++i) matrix.emplace_back(i, i, model_.target_stiffness[i / 3] / stiffness_unit_);
    for (size_t j = 0; j < taut_.edge.size(); ++j) {
        const int e = taut_.edge[j], z = coordinates + 8 * static_cast<int>(j);
        const Eigen::Vector3d n = edge_vector(model_, r, e).normalized();
        const double stiffness = multiplier[e] / model_.edge_max_length[e] / stiffness_unit_;
        stiffest_ = std::max(stiffest_, stiffness);
        for (int c = 0; c < 3; ++c) {
            matrix.emplace_back(z + 1 + c, 3 * model_.edge(e, 0) + c, -1.0);  // G_e
            matrix.emplace_back(z + 1 + c, 3 * model_.edge(e, 1) + c, 1.0);
        }
        add_cone(z, n, stiffness, matrix);
        const double k_a = model_.target_stiffness[model_.edge(e, 0)] / stiffness_unit_;
        const double k_b = model_.target_stiffness[model_.edge(e, 1)] / stiffness_unit_;
        add_shift(z, n, std::max(k_a / (k_a + k_b) * k_b, stiffness), along, across);
    }
    for (auto [target, entries] : {std::pair{&matrix_, &matrix}, {&along_, &along}, {&across_, &across}}) {
        target->resize(size, size);
        target->setFromTriplets(entries->begin(), entries->end());
    }
}

double ConeDerivative::error_of(double size, bool inconsistent) {
    const auto matrix = matrix_.selfadjointView<Eigen::Lower>();
    residual_ = right_;
    residual_.noalias() -= matrix * solution_;
    if (!inconsistent) return residual_.cwiseAbs().maxCoeff() / size;
    // What the range of the matrix cannot express is orthogonal to it, so a product with the matrix leaves it out.
    correction_.noalias() = matrix * residual_;
    return correction_.cwiseAbs().maxCoeff() / size;
}

double ConeDerivative::solve(bool inconsistent) {
    solution_.setZero(right_.size());
    const double size = right_.size() > 0 ? right_.cwiseAbs().maxCoeff() : 0.0;
    if (!(size > 0.0)) return 0.0;
    double shift = kShiftAlong / stiffest_;
    double error = error_of(size, inconsistent);
    for (int attempt = 0; attempt < kMaxFactorisations && !(error <= kConverged); ++attempt, shift *= kLowerShift) {
        const SparseMatrix shifted = matrix_ + across_ - shift * along_;
        QuasidefiniteLdl ldl(shifted);
        if (!ldl.factor(shifted)) break;
        for (int k = 0; k < kMaxIterations && error > kSolved; ++k) {
            ldl.solve(residual_, correction_);
            solution_ += correction_;
            const double last = error;
            error = error_of(size, inconsistent);
            if (!(error < last)) break;
        }
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
