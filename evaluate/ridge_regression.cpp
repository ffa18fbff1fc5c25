#include "evaluate/ridge_regression.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace toile::evaluate {
namespace {

constexpr double rounding = 1e-12;  // of an eigenvalue, relative to the largest
constexpr int strengths = 41;

/// The sums in the features' principal axes, those without variance left out.
struct Axes {
    Eigen::MatrixXd direction;       ///< `[D x r]`
    Eigen::VectorXd variance;        ///< `[r]` s
    Eigen::MatrixXd target;          ///< `[r x k]` c
    Eigen::VectorXd target_squared;  ///< `[r]` |c|²
    double unexplained = 0;          ///< Σ |t|² that no weights explain
};

Axes principal_axes(const RidgeSums& sums) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sums.feature_feature);
    const Eigen::VectorXd& all = solver.eigenvalues();  // rising
    Eigen::Index rank = 0;
    while (rank < all.size() && all[all.size() - 1 - rank] > rounding * all[all.size() - 1]) ++rank;
    Axes axes;
    axes.direction = solver.eigenvectors().rightCols(rank);
    axes.variance = all.tail(rank);
    axes.target = axes.direction.transpose() * sums.feature_target;
    axes.target_squared = axes.target.rowwise().squaredNorm();
    const double left = sums.target_squared - (axes.target_squared.array() / axes.variance.array()).sum();
    if (left > rounding * sums.target_squared) axes.unexplained = left;  // below it is what subtracting left behind
    return axes;
}

/// Mean squared error foreseen on other samples. `penalty` is L s, above 0.
double cross_validation(const Axes& axes, double penalty, std::int64_t count) {
    const Eigen::ArrayXd share = penalty / (axes.variance.array() + penalty);
    const double squared =
        axes.unexplained + (axes.target_squared.array() * share.square() / axes.variance.array()).sum();
    const double free = static_cast<double>(count - 1 - axes.variance.size()) + share.sum();
    const double n = static_cast<double>(count);
    return squared / n / ((free / n) * (free / n));
}

double chosen_strength(const Axes& axes, double size, std::int64_t count) {
    double best = std::numeric_limits<double>::infinity(), strength = 0;
    for (int i = strengths - 1; i >= 0; --i) {
        const double candidate = static_cast<double>(count) * std::pow(10.0, -8.0 + 0.25 * i);
        const double score = cross_validation(axes, candidate * size, count);
        if (score < best) {
            best = score;
            strength = candidate;
        }
    }
    return strength;
}

}  // namespace

RidgeSums::RidgeSums(Eigen::Index features, Eigen::Index targets)
    : feature_feature(Eigen::MatrixXd::Zero(features, features)),
      feature_target(Eigen::MatrixXd::Zero(features, targets)) {}

void RidgeSums::add(const Eigen::VectorXd& feature, const Eigen::VectorXd& target) {
    feature_feature.noalias() += feature * feature.transpose();
    feature_target.noalias() += feature * target.transpose();
    target_squared += target.squaredNorm();
    ++count;
}

RidgeFit fit_ridge(const RidgeSums& sums, std::optional<double> ridge) {
    const Eigen::Index features = sums.feature_feature.rows(), targets = sums.feature_target.cols();
    RidgeFit fit{Eigen::MatrixXd::Zero(targets, features), ridge.value_or(0.0),
                 std::sqrt(sums.target_squared / static_cast<double>(sums.count))};
    const double size = sums.feature_feature.trace() / static_cast<double>(sums.count);
    if (features == 0 || targets == 0 || !(size > 0)) return fit;
    const Axes axes = principal_axes(sums);
    fit.ridge = ridge ? *ridge : chosen_strength(axes, size, sums.count);
    const double penalty = fit.ridge * size;
    const Eigen::VectorXd inverse = (axes.variance.array() + penalty).inverse();
    fit.weights = (axes.direction * inverse.asDiagonal() * axes.target).transpose();
    // without a penalty the formula's limit, to all digits that matter
    fit.cross_error = std::sqrt(cross_validation(axes, std::max(penalty, rounding * axes.variance[0]), sums.count));
    return fit;
}

}  // namespace toile::evaluate
