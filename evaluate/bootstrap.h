#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace toile::evaluate {

struct Interval {
    double low, high;
};

/// How samples are put together to one figure.
enum class Gather { mean, root_of_mean_square };
double gathered(Gather gather, std::span<const double> value);

/// Percentile bootstrap over samples (Efron and Tibshirani 1993, Section 13.3): as many samples are drawn from the N,
/// with replacement, 2,000 times; an interval goes from the 2.5th to the 97.5th percentile of the figures that the
/// draws give. It knows of no uncertainty but the choice of the samples, and is too narrow for a handful of them.
///
/// All figures of one object see the same draws: the interval of a difference between two methods is that of the
/// paired bootstrap. The draws depend on N and the seed alone.
class Bootstrap {
  public:
    static constexpr int draws = 2000;

    Bootstrap(int samples, std::uint64_t seed);

    int samples() const { return static_cast<int>(count_.cols()); }
    /// The figure of each draw `[draws]` from the samples' values `[N]`.
    Eigen::VectorXd figures(Gather gather, std::span<const double> value) const;

  private:
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> count_;  ///< `[draws x N]`
};

/// The middle 95 % of figures; NaN where one is not finite.
Interval interval_of(Eigen::VectorXd figures);

}  // namespace toile::evaluate
