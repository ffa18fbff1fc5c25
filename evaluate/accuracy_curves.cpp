#include "evaluate/accuracy_curves.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "files/hdf5_file.h"

namespace toile::evaluate {
namespace {

constexpr int histogram_bins = 24;

struct CurveKind {
    const char* id;
    const char* title;
    const char* method;  ///< how the names of its methods begin
    Quantity quantity;
    ReportAxis x;
};

const CurveKind curve_kinds[] = {
    {"accuracy-mu", "Error against μ of the quasistatic prior", "quasistatic@mu=", Quantity::sqrt_mse, {"μ", "", true}},
    {"accuracy-mu-stretching",
     "Stretching energy error against μ",
     "quasistatic@mu=",
     Quantity::stretching_energy_error,
     {"μ", "", true}},
    {"accuracy-mu-compression",
     "Compression energy error against μ",
     "quasistatic@mu=",
     Quantity::compression_energy_error,
     {"μ", "", true}},
    {"accuracy-mu-penetration", "Penetration against μ", "quasistatic@mu=", Quantity::penetration, {"μ", "", true}},
    {"accuracy-limit",
     "Error against the limit of the inextensibility prior",
     "inextensibility@limit=",
     Quantity::sqrt_mse,
     {"limit", "", false}},
};

ReportPoint point_of(double x, const files::Metric& metric, std::string label) {
    ReportPoint point{x, metric.value};
    point.y_low = metric.low;
    point.y_high = metric.high;
    point.label = std::move(label);
    return point;
}

/// A predictor's points, by x; what has a name instead of a number ("best") lies among them.
ReportSeries series_of(const AccuracyDocument& document, const AccuracyDocument::Predictor& predictor,
                       const std::string& split, const CurveKind& kind) {
    ReportSeries series{predictor.name};
    for (const AccuracyDocument::Method& method : predictor.method) {
        if (!method.name.starts_with(kind.method) || method.name.ends_with("=vertex")) continue;
        const files::Metric* metric = document.find(predictor.name, split, method.name, kind.quantity);
        if (!metric || !std::isfinite(metric->value)) continue;
        series.points.push_back(point_of(method.setting, *metric, method.name));
    }
    std::stable_sort(series.points.begin(), series.points.end(),
                     [](const auto& a, const auto& b) { return a.x < b.x; });
    return series;
}

/// A level line for the prediction as it is, over the same range.
ReportSeries level_of(const AccuracyDocument& document, const AccuracyDocument::Predictor& predictor,
                      const std::string& split, const CurveKind& kind, const ReportSeries& beside) {
    ReportSeries series{predictor.name + ", as predicted"};
    const std::string& method = predictor.method.front().name;
    const files::Metric* metric = document.find(predictor.name, split, method, kind.quantity);
    if (metric && std::isfinite(metric->value))
        for (const double x : {beside.points.front().x, beside.points.back().x})
            series.points.push_back(point_of(x, *metric, method));
    return series;
}

std::vector<double> sample_errors(const files::Hdf5File& file, const std::vector<std::int8_t>& splits, int split,
                                  const std::string& predictor, const std::string& method) {
    const auto value = file.read<double>("/figures/" + predictor + "/" + method + "/sqrt_mse",
                                         {static_cast<std::int64_t>(splits.size())})
                           .value;
    std::vector<double> errors;
    for (size_t k = 0; k < value.size(); ++k)
        if (splits[k] == split && std::isfinite(value[k])) errors.push_back(value[k]);
    return errors;
}

}  // namespace

std::vector<ReportCurves> accuracy_curves(const AccuracyDocument& document, const std::string& split) {
    std::vector<ReportCurves> all;
    for (const CurveKind& kind : curve_kinds) {
        const QuantityKind& quantity = quantity_kind(kind.quantity);
        // Predictors may lie decades apart; penetration and energies may be zero, which has no logarithm.
        const bool log = kind.quantity == Quantity::sqrt_mse && kind.x.log;
        ReportCurves curves{std::string(kind.id) + "-" + split,
                            std::string(kind.title) + ", " + split + " split",
                            "With 95 % bootstrap intervals over samples. Level lines: the prediction as it is.",
                            kind.x,
                            {quantity.title, quantity.unit, log}};
        for (const AccuracyDocument::Predictor& predictor : document.predictor) {
            ReportSeries series = series_of(document, predictor, split, kind);
            if (series.points.size() < 2) continue;
            ReportSeries level = level_of(document, predictor, split, kind, series);
            curves.series.push_back(std::move(series));
            if (!level.points.empty()) curves.series.push_back(std::move(level));
        }
        if (!curves.series.empty()) all.push_back(std::move(curves));
    }
    return all;
}

ReportHistogram histogram_of(std::string id, std::string title,
                             const std::vector<std::pair<std::string, std::vector<double>>>& series, int bins) {
    double low = INFINITY, high = 0;
    for (const auto& [name, values] : series)
        for (const double one : values) {
            if (one > 0) low = std::min(low, one);
            high = std::max(high, one);
        }
    if (!(low < high)) {
        low = high > 0 ? 0.5 * high : 0.5;
        high = high > 0 ? 2 * high : 2.0;
    }
    std::vector<double> edges;
    for (int k = 0; k <= bins; ++k) edges.push_back(low * std::pow(high / low, static_cast<double>(k) / bins));
    ReportHistogram histogram{std::move(id), std::move(title), "", {"SqrtMSE of a sample", "mm", true}};
    for (const auto& [name, values] : series) {
        std::vector<double> counts(static_cast<size_t>(bins), 0.0);
        for (const double one : values) {
            const auto above = std::upper_bound(edges.begin(), edges.end(), one) - edges.begin();
            counts[static_cast<size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, bins - 1))] += 1;
        }
        histogram.series.push_back({name, edges, std::move(counts)});
    }
    return histogram;
}

std::vector<ReportHistogram> accuracy_histograms(const AccuracyDocument& document, const std::string& split,
                                                 const std::string& arrays) {
    const files::Hdf5File file = files::Hdf5File::open(arrays);
    const auto splits = file.read<std::int8_t>("/figures/split", {files::any_size}).value;
    const int number = split == "train" ? 0 : split == "validation" ? 1 : 2;
    std::vector<ReportHistogram> all;
    for (const AccuracyDocument::Predictor& predictor : document.predictor) {
        std::vector<std::pair<std::string, std::vector<double>>> series;
        for (const AccuracyDocument::Method& method : predictor.method) {
            const bool told = &method == &predictor.method.front() || method.name == "quasistatic@mu=best" ||
                              method.name == "quasistatic@mu=vertex" || method.name == "inextensibility@limit=0";
            if (told)
                series.emplace_back(method.name, sample_errors(file, splits, number, predictor.name, method.name));
        }
        all.push_back(histogram_of("accuracy-histogram-" + predictor.name,
                                   "Errors of the " + split + " samples, " + predictor.name, series, histogram_bins));
    }
    return all;
}

}  // namespace toile::evaluate
