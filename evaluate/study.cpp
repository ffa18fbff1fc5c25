#include "evaluate/study.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <limits>

namespace toile::evaluate {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A shared machine moves a ratio of two times by this much without anything being wrong.
constexpr double ratio_tolerance = 0.3;
/// What takes less of a unit than this is told, not gated: caches and interrupts decide on it.
constexpr double least_gated_ratio = 0.05;

files::Metric metric_of(const std::string& name, const Spread& value, const std::string& unit, int samples) {
    files::Metric metric;
    metric.name = "runtime/" + name;
    metric.value = value.middle;
    metric.low = value.low;
    metric.high = value.high;
    metric.unit = unit;
    metric.samples = samples;
    return metric;
}

}  // namespace

void add_metric(Study& study, const std::string& name, const Spread& value, const std::string& unit, int samples,
                double tolerance) {
    files::Metric metric = metric_of(study.name + "/" + name, value, unit, samples);
    if (tolerance > 0.0) {
        metric.direction = files::MetricDirection::lower;
        metric.tolerance = tolerance;
    }
    study.metric.push_back(metric);
}

void add_time_metrics(Study& study, const std::string& name, const Timings& timings, int task, int samples) {
    add_metric(study, name + "/seconds", timings.seconds(task), "s", samples);
    const Spread units = timings.units(task);
    const double tolerance = units.middle >= least_gated_ratio ? ratio_tolerance : 0.0;
    if (std::isfinite(units.middle)) add_metric(study, name + "/time_ratio", units, "ratio", samples, tolerance);
}

PowerLaw fit_power_law(const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> u, v;
    for (size_t k = 0; k < x.size(); ++k)
        if (x[k] > 0.0 && y[k] > 0.0) {
            u.push_back(std::log(x[k]));
            v.push_back(std::log(y[k]));
        }
    const auto count = static_cast<double>(u.size());
    double mean_u = 0, mean_v = 0, uu = 0, uv = 0, left = 0;
    for (size_t k = 0; k < u.size(); ++k) {
        mean_u += u[k] / count;
        mean_v += v[k] / count;
    }
    for (size_t k = 0; k < u.size(); ++k) {
        uu += (u[k] - mean_u) * (u[k] - mean_u);
        uv += (u[k] - mean_u) * (v[k] - mean_v);
    }
    PowerLaw law{not_a_number, not_a_number, not_a_number, not_a_number};
    if (u.size() < 2 || uu < 1e-12) return law;
    law.exponent = uv / uu;
    law.factor = std::exp(mean_v - law.exponent * mean_u);
    if (u.size() < 3) return law;
    for (size_t k = 0; k < u.size(); ++k) {
        const double off = v[k] - mean_v - law.exponent * (u[k] - mean_u);
        left += off * off;
    }
    const double error = std::sqrt(left / (count - 2.0) / uu);
    law.exponent_low = law.exponent - 2.0 * error;
    law.exponent_high = law.exponent + 2.0 * error;
    return law;
}

std::string short_number(double value) {
    if (!std::isfinite(value)) return "-";
    return fmt::format("{:.3g}", value);
}

}  // namespace toile::evaluate
