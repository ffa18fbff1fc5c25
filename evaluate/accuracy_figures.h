#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/bootstrap.h"
#include "evaluate/quantity.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// The splits as a data set numbers them.
const char* split_name(int split);

/// Of one predictor (or of the truth itself) and one method: a row for each judged sample.
struct MethodFigures {
    std::string method, title;
    double setting = 0;                  ///< see `PriorMethod`
    std::vector<QuantityValues> sample;  ///< `[N]` in the order of `AccuracyFigures::id`
    std::vector<std::int8_t> status;     ///< `[N]` prior::Status; 0 of the prediction itself
};

struct PredictorFigures {
    std::string predictor;
    std::vector<MethodFigures> method;  ///< the first is the prediction as it is
};

/// Every value of an evaluation: a few numbers a sample.
struct AccuracyFigures {
    std::vector<std::int64_t> id;  ///< `[N]`
    std::vector<int> split;        ///< `[N]`
    PredictorFigures truth;        ///< what the targets themselves are like: one method, "target"
    std::vector<PredictorFigures> predictor;

    std::vector<int> rows_of(int split) const;  ///< the samples of a split
};

/// The simulator's own error in each quantity, in its unit; NaN where it is not known.
struct NoiseFloor {
    QuantityValues value;
    int samples = 0;  ///< pairs of drapes it is made of
    std::string source;
};

/// How a method compares with the prediction as it is.
enum class Judgement { better, worse, below_noise, below_interval, too_few };
/// "better", "worse", "smaller than the simulator's noise", "smaller than its own interval", "too few samples to tell".
const char* judgement_text(Judgement judgement);

/// Below this many samples nothing is said about a difference.
inline constexpr int fewest_samples = 5;

struct Comparison {
    std::string predictor, split, method;
    Quantity quantity = Quantity::sqrt_mse;
    double difference = 0;    ///< the method's figure less the prediction's
    Interval interval{0, 0};  ///< 95 %, by the paired bootstrap
    Judgement judgement = Judgement::too_few;
};

/// A difference that its interval does not tell from zero is called that, one that is told from zero but smaller than
/// the noise floor (NaN: not known) is called this, else it is better or worse.
Judgement judge_difference(double difference, const Interval& interval, double floor, int samples);

struct AccuracyVerdicts {
    std::vector<files::Metric> metric;
    std::vector<Comparison> comparison;  ///< of the quantities with a direction
};

/// Metrics "accuracy/<predictor>/<split>/<method>/<quantity>" with distributions over samples and bootstrap intervals,
/// those of the truth under the predictor "target", and what they say.
AccuracyVerdicts judge_figures(const AccuracyFigures& figures, const std::optional<NoiseFloor>& floor,
                               std::uint64_t seed);

}  // namespace toile::evaluate
