#include "prior/cone_polish.h"

#include <algorithm>
#include <chrono>

namespace toile::prior {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCompliance = 1e-6;  // δ, over the largest λ_e / l_e^max where that is above the mean stiffness

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

void ConePolish::assemble(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) {
    const Edges& edge = program_.edge;
    direction_.resize(3, edge.rows());
    length_.resize(edge.rows());
    active_.assign(static_cast<size_t>(edge.rows()), 0);
    right_.setZero(kkt_.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) right_[i] = -program_.stiffness[i / 3] * u[i];
    const double largest = lambda.maxCoeff();
    const double compliance = kCompliance / std::max(1.0, lambda.cwiseQuotient(program_.limit).maxCoeff());
    kkt_.begin(program_.stiffness);
    for (Eigen::Index e = 0; e < edge.rows(); ++e) {
        const Eigen::Index a = 3 * edge(e, 0), b = 3 * edge(e, 1);
        const Eigen::Vector3d vector = program_.edge_vector.col(e) + u.segment<3>(a) - u.segment<3>(b);
        length_[e] = vector.norm();
        const double k_a = program_.stiffness[edge(e, 0)], k_b = program_.stiffness[edge(e, 1)];
        double stiffness = k_a * k_b / (k_a + k_b);
        if (by_largest_) stiffness = std::max(stiffness, largest / program_.limit[e]);
        if (!(length_[e] > 0.0) || lambda[e] <= stiffness * (program_.limit[e] - length_[e])) {
            kkt_.set_edge(e, 0.0, Eigen::Vector3d::Zero(), 1.0);
            continue;
        }
        active_[static_cast<size_t>(e)] = 1;
        direction_.col(e) = vector / length_[e];
        // Along n_e, λ/l (I − n nᵀ) has no stiffness; where the row fixes the length it may as well have λ/l, which
        // leaves one scalar for each edge. `step` takes it out of dλ again.
        kkt_.set_edge(e, lambda[e] / length_[e], direction_.col(e), compliance);
        right_.segment<3>(a) -= lambda[e] * direction_.col(e);
        right_.segment<3>(b) += lambda[e] * direction_.col(e);
        right_[u.size() + e] = program_.limit[e] - length_[e];
    }
}

bool ConePolish::step(Eigen::VectorXd& u, Eigen::VectorXd& lambda, Report& report) {
    auto before = Clock::now();
    assemble(u, lambda);
    report.seconds_assembly += seconds_since(before);
    before = Clock::now();
    const bool factored = kkt_.factor();
    report.seconds_factor += seconds_since(before);
    if (!factored) return false;

    before = Clock::now();
    kkt_.solve(right_, solution_);
    report.seconds_solve += seconds_since(before);
    if (!solution_.allFinite()) return false;
    u += solution_.head(u.size());
    for (Eigen::Index e = 0; e < lambda.size(); ++e) {
        if (!active_[static_cast<size_t>(e)]) {
            lambda[e] = 0.0;
            continue;
        }
        const Eigen::Index a = 3 * program_.edge(e, 0), b = 3 * program_.edge(e, 1);
        const double stretched = direction_.col(e).dot(solution_.segment<3>(a) - solution_.segment<3>(b));  // N du
        lambda[e] = std::max(0.0, lambda[e] + solution_[u.size() + e] + lambda[e] / length_[e] * stretched);
    }
    return true;
}

}  // namespace toile::prior
