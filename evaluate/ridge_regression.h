#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace toile::evaluate {

/// What ridge regression needs of its samples, gathered one by one: memory does not grow with their number.
struct RidgeSums {
    RidgeSums(Eigen::Index features, Eigen::Index targets);
    /// Features `[D]` and targets `[k]`, both less their mean over all samples that will be added.
    void add(const Eigen::VectorXd& feature, const Eigen::VectorXd& target);

    Eigen::MatrixXd feature_feature;  ///< `[D x D]` Σ x xᵀ
    Eigen::MatrixXd feature_target;   ///< `[D x k]` Σ x tᵀ
    double target_squared = 0;        ///< Σ |t|²
    std::int64_t count = 0;
};

struct RidgeFit {
    Eigen::MatrixXd weights;  ///< `[k x D]` W, t ≈ W x
    double ridge = 0;         ///< L, given or chosen
    double cross_error =
        0;  ///< root mean square |t − W x|, as generalised cross-validation foresees it on other samples
};

/// The W that minimises Σ |t − W x|² + L s |W|², s = Σ |x|² / N: the strength L counts in samples of mean size, so that
/// it means the same for any features.
///
/// Without `ridge`, L is the one of 41 in the ratio 10^¼ from 1e-8 N to 100 N with the least generalised
/// cross-validation score (Golub, Heath, Wahba 1979), which is leave-one-out with each sample's leverage replaced by
/// their mean; the mean that was taken off counts as one fitted number. The larger L wins a tie. Directions in which
/// the features do not vary have weight zero.
RidgeFit fit_ridge(const RidgeSums& sums, std::optional<double> ridge);

}  // namespace toile::evaluate
