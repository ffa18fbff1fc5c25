#pragma once

#include <string>
#include <vector>

#include "files/metric_file.h"

namespace toile::files {

/// What became of one metric since a baseline.
struct MetricChange {
    enum class Outcome {
        regressed,  ///< worse by more than `allowed`
        missing,    ///< judged in the baseline, and not measured now, or in another unit
        improved,   ///< better by more than `allowed`
        within,     ///< no further off than `allowed`
        untold,     ///< without a direction, or without a number in the baseline: not judged
        added       ///< not in the baseline
    };
    Outcome outcome = Outcome::untold;
    Metric baseline, measured;  ///< the latter's name is empty where it is missing, the former's where it was added
    double allowed = Metric::missing;  ///< in the metric's unit

    const std::string& name() const { return baseline.name.empty() ? measured.name : baseline.name; }
    bool trips() const { return outcome == Outcome::regressed || outcome == Outcome::missing; }
    /// "accuracy/…/sqrt_mse: 8.1 mm, baseline 7.4 mm, worse by 0.7, allowed 0.37"
    std::string line() const;
};

/// How far a metric may move before it is called better or worse: the largest of the baseline's tolerance times its
/// value, the noise of the difference (both intervals' half widths, root of the sum of squares) and either's floor.
double allowed_change(const Metric& baseline, const Metric& measured);

/// Direction and tolerance are the baseline's. Regressed first, then missing, then the rest, in the baseline's order;
/// what was added last.
std::vector<MetricChange> compare_metrics(const std::vector<Metric>& baseline, const std::vector<Metric>& measured);

}  // namespace toile::files
