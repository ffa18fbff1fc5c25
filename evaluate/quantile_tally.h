#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace toile::evaluate {

/// Counts numbers so that any quantile of them can be told to 2.5e-4 relative at worst, in memory that does not
/// grow with their number: a class for every 1/4096 of each power of two, which keeps the mean of what fell into it.
/// Numbers that are not finite are counted apart. The same numbers in the same order give the same results to the last
/// bit.
class QuantileTally {
  public:
    QuantileTally();
    void add(double value);
    std::int64_t count() const { return count_; }  ///< of the finite ones
    std::int64_t not_finite() const { return not_finite_; }
    double mean() const;                           ///< NaN of none, as all that follow
    double smallest() const { return smallest_; }  ///< exact
    double largest() const { return largest_; }    ///< exact
    double quantile(double share) const;           ///< the value that `share` of all lie at or below

    struct Histogram {
        std::vector<double> edges, counts;  ///< `[n + 1]`, `[n]`
    };
    /// `bins` of equal width from the quantile 0.001 to 0.999; what lies outside counts in the
    /// outer bins. Empty of none.
    Histogram histogram(int bins) const;

  private:
    struct Class {
        std::int64_t count = 0;
        double sum = 0;
        double mean() const { return sum / static_cast<double>(count); }
    };
    std::map<std::int64_t, Class> class_;
    std::int64_t count_ = 0, not_finite_ = 0;
    double sum_ = 0, smallest_, largest_;
};

}  // namespace toile::evaluate
