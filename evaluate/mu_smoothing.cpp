#include "evaluate/mu_smoothing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace toile::evaluate {

MuSmoothing::MuSmoothing(const Triangles& triangle, int vertex_count) : laplacian_(vertex_count, vertex_count) {
    const double weight = 0.5 / std::sqrt(3.0);
    std::vector<Eigen::Triplet<double>> entry;
    for (Eigen::Index f = 0; f < triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int a = triangle(f, corner), b = triangle(f, (corner + 1) % 3);
            entry.emplace_back(a, a, weight);
            entry.emplace_back(b, b, weight);
            entry.emplace_back(a, b, -weight);
            entry.emplace_back(b, a, -weight);
        }
    laplacian_.setFromTriplets(entry.begin(), entry.end());
}

MuVariables::MuVariables(const MuSmoothing& smoothing, double weight, double low, double high)
    : middle_(0.5 * (std::log(low) + std::log(high))), half_(0.5 * (std::log(high) - std::log(low))) {
    const Eigen::SparseMatrix<double>& laplacian = smoothing.laplacian();
    Eigen::SparseMatrix<double> unit(laplacian.rows(), laplacian.cols());
    unit.setIdentity();
    factor_.compute(weight * laplacian + 1.0 / static_cast<double>(laplacian.rows()) * unit);
}

// P M Pᵀ = L Lᵀ, so R = Lᵀ P.
Eigen::VectorXd MuVariables::unbounded(const Eigen::VectorXd& z) const {
    return factor_.permutationPinv() * Eigen::VectorXd(factor_.matrixU().solve(z));
}

Eigen::VectorXd MuVariables::log_mu(const Eigen::VectorXd& z) const {
    return (middle_ + half_ * ((unbounded(z).array() - middle_) / half_).tanh()).matrix();
}

Eigen::VectorXd MuVariables::of(const Eigen::VectorXd& log_mu) const {
    const auto unbounded = [&](double x) {
        return middle_ + half_ * std::atanh(std::clamp((x - middle_) / half_, -0.998, 0.998));
    };
    const Eigen::VectorXd permuted = factor_.permutationP() * Eigen::VectorXd(log_mu.unaryExpr(unbounded));
    return factor_.matrixU() * permuted;
}

Eigen::VectorXd MuVariables::pull_back(const Eigen::VectorXd& by_log_mu, const Eigen::VectorXd& z) const {
    const Eigen::ArrayXd slope = 1.0 - ((unbounded(z).array() - middle_) / half_).tanh().square();
    const Eigen::VectorXd permuted = factor_.permutationP() * Eigen::VectorXd(slope * by_log_mu.array());
    return factor_.matrixL().solve(permuted);
}

}  // namespace toile::evaluate
