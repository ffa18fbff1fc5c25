#include "evaluate/accuracy_figures.h"

#include <algorithm>
#include <cmath>

#include "generate/distribution.h"

namespace toile::evaluate {
namespace {

/// How much worse a figure may become before a baseline calls it a regression.
constexpr double tolerance = 0.05;

Gather gather_of(int quantity) {
    return quantity_kind(quantity).root_of_squares ? Gather::root_of_mean_square : Gather::mean;
}

std::vector<double> column(const MethodFigures& method, const std::vector<int>& row, int quantity) {
    std::vector<double> value;
    for (const int k : row) value.push_back(method.sample[static_cast<size_t>(k)][static_cast<size_t>(quantity)]);
    return value;
}

bool is_absent(const std::vector<double>& value) {
    return std::all_of(value.begin(), value.end(), [](double one) { return std::isnan(one); });
}

/// One split of one predictor.
class SplitJudge {
  public:
    SplitJudge(const AccuracyFigures& figures, const std::optional<NoiseFloor>& floor, const Bootstrap& bootstrap,
               int split, AccuracyVerdicts& verdicts)
        : row_(figures.rows_of(split)),
          floor_(floor),
          bootstrap_(bootstrap),
          split_(split_name(split)),
          verdicts_(verdicts) {}

    void judge(const PredictorFigures& predictor) {
        for (int q = 0; q < quantity_count; ++q) {
            const std::vector<double> first = column(predictor.method.front(), row_, q);
            const Eigen::VectorXd first_draws = bootstrap_.figures(gather_of(q), first);
            for (const MethodFigures& method : predictor.method) {
                const std::vector<double> value = column(method, row_, q);
                if (is_absent(value)) continue;
                const Eigen::VectorXd draws = bootstrap_.figures(gather_of(q), value);
                add_metric(predictor.predictor, method.method, q, value, draws);
                const bool judged = quantity_kind(q).direction != files::MetricDirection::none;
                if (judged && &method != &predictor.method.front())
                    compare(predictor.predictor, method.method, q,
                            gathered(gather_of(q), value) - gathered(gather_of(q), first), draws - first_draws);
            }
        }
    }

  private:
    double floor_of(int q) const { return floor_ ? floor_->value[static_cast<size_t>(q)] : files::Metric::missing; }

    void add_metric(const std::string& predictor, const std::string& method, int q, const std::vector<double>& value,
                    const Eigen::VectorXd& draws) {
        const QuantityKind& kind = quantity_kind(q);
        files::Metric metric;
        metric.name = "accuracy/" + predictor + "/" + split_ + "/" + method + "/" + kind.name;
        metric.value = gathered(gather_of(q), value);
        const Interval interval = interval_of(draws);
        metric.low = interval.low;
        metric.high = interval.high;
        metric.unit = kind.unit;
        metric.direction = predictor == "target" ? files::MetricDirection::none : kind.direction;
        metric.tolerance = tolerance;
        metric.samples = static_cast<int>(value.size());
        const generate::Distribution spread = generate::distribution(value);
        metric.distribution = {spread.median, spread.ninety_fifth, spread.ninety_ninth, spread.largest};
        if (std::isfinite(floor_of(q))) metric.floor = floor_of(q);
        verdicts_.metric.push_back(std::move(metric));
    }

    void compare(const std::string& predictor, const std::string& method, int q, double difference,
                 const Eigen::VectorXd& draws) {
        Comparison one{predictor, split_, method, static_cast<Quantity>(q), difference, interval_of(draws)};
        one.judgement = judge_difference(difference, one.interval, floor_of(q), static_cast<int>(row_.size()));
        verdicts_.comparison.push_back(std::move(one));
    }

    std::vector<int> row_;
    const std::optional<NoiseFloor>& floor_;
    const Bootstrap& bootstrap_;
    std::string split_;
    AccuracyVerdicts& verdicts_;
};

}  // namespace

const char* split_name(int split) {
    return split == 0 ? "train" : split == 1 ? "validation" : "test";
}

std::vector<int> AccuracyFigures::rows_of(int wanted) const {
    std::vector<int> row;
    for (size_t k = 0; k < split.size(); ++k)
        if (split[k] == wanted) row.push_back(static_cast<int>(k));
    return row;
}

const char* judgement_text(Judgement judgement) {
    switch (judgement) {
        case Judgement::better:
            return "better";
        case Judgement::worse:
            return "worse";
        case Judgement::below_noise:
            return "smaller than the simulator's noise";
        case Judgement::below_interval:
            return "smaller than its own interval";
        case Judgement::too_few:
            return "too few samples to tell";
    }
    return "unknown";
}

Judgement judge_difference(double difference, const Interval& interval, double floor, int samples) {
    if (samples < fewest_samples) return Judgement::too_few;
    const bool told_from_zero = interval.low > 0 || interval.high < 0;
    if (!told_from_zero) return Judgement::below_interval;
    if (std::isfinite(floor) && std::abs(difference) < floor) return Judgement::below_noise;
    return difference < 0 ? Judgement::better : Judgement::worse;
}

AccuracyVerdicts judge_figures(const AccuracyFigures& figures, const std::optional<NoiseFloor>& floor,
                               std::uint64_t seed) {
    AccuracyVerdicts verdicts;
    for (int split = 0; split < 3; ++split) {
        const int samples = static_cast<int>(figures.rows_of(split).size());
        if (samples == 0) continue;
        const Bootstrap bootstrap(samples, seed + static_cast<std::uint64_t>(split));
        SplitJudge judge(figures, floor, bootstrap, split, verdicts);
        judge.judge(figures.truth);
        for (const PredictorFigures& predictor : figures.predictor) judge.judge(predictor);
    }
    return verdicts;
}

}  // namespace toile::evaluate
