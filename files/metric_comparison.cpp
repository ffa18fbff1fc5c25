#include "files/metric_comparison.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <unordered_map>

namespace toile::files {
namespace {

using Outcome = MetricChange::Outcome;

/// Half the width of the interval; 0 where there is none.
double half_width(const Metric& metric) {
    const double width = metric.high - metric.low;
    return std::isfinite(width) ? 0.5 * width : 0.0;
}

/// How much worse, in the metric's unit; negative for better.
double worse_by(const MetricChange& change) {
    const double rise = change.measured.value - change.baseline.value;
    return change.baseline.direction == MetricDirection::higher ? -rise : rise;
}

Outcome outcome(const MetricChange& change) {
    const Metric& baseline = change.baseline;
    if (baseline.direction == MetricDirection::none || !std::isfinite(baseline.value)) return Outcome::untold;
    const Metric& measured = change.measured;
    if (!std::isfinite(measured.value) || measured.unit != baseline.unit) return Outcome::missing;
    const double worse = worse_by(change);
    if (worse > change.allowed) return Outcome::regressed;
    return worse < -change.allowed ? Outcome::improved : Outcome::within;
}

int rank(const MetricChange& change) {
    switch (change.outcome) {
        case Outcome::regressed:
            return 0;
        case Outcome::missing:
            return 1;
        case Outcome::added:
            return 3;
        default:
            return 2;
    }
}

}  // namespace

double allowed_change(const Metric& baseline, const Metric& measured) {
    double allowed = baseline.tolerance * std::abs(baseline.value);
    allowed = std::max(allowed, std::hypot(half_width(baseline), half_width(measured)));
    for (const Metric* metric : {&baseline, &measured})
        if (metric->floor && std::isfinite(*metric->floor)) allowed = std::max(allowed, *metric->floor);
    return allowed;
}

std::vector<MetricChange> compare_metrics(const std::vector<Metric>& baseline, const std::vector<Metric>& measured) {
    std::unordered_map<std::string, const Metric*> now;
    for (const Metric& metric : measured) now.emplace(metric.name, &metric);
    std::vector<MetricChange> changes;
    for (const Metric& before : baseline) {
        MetricChange change;
        change.baseline = before;
        if (const auto found = now.find(before.name); found != now.end()) {
            change.measured = *found->second;
            change.allowed = allowed_change(before, change.measured);
            now.erase(found);
        }
        change.outcome = outcome(change);
        changes.push_back(std::move(change));
    }
    for (const Metric& metric : measured)
        if (now.contains(metric.name)) {
            MetricChange change;
            change.outcome = Outcome::added;
            change.measured = metric;
            changes.push_back(std::move(change));
        }
    std::stable_sort(changes.begin(), changes.end(),
                     [](const MetricChange& a, const MetricChange& b) { return rank(a) < rank(b); });
    return changes;
}

std::string MetricChange::line() const {
    std::ostringstream text;
    text.precision(4);
    text << name() << ": ";
    if (outcome == Outcome::missing) {
        if (measured.name.empty())
            text << "not measured";
        else if (measured.unit != baseline.unit)
            text << "measured in another unit, \"" << measured.unit << '"';
        else
            text << "measured without a number";
        text << ", baseline " << baseline.value << ' ' << baseline.unit;
    } else if (outcome == Outcome::added) {
        text << measured.value << ' ' << measured.unit << ", not in the baseline";
    } else {
        const double worse = worse_by(*this);
        text << measured.value << ' ' << measured.unit << ", baseline " << baseline.value << ' ' << baseline.unit
             << (worse > 0 ? ", worse by " : ", better by ") << std::abs(worse) << ", allowed " << allowed;
    }
    return text.str();
}

}  // namespace toile::files
