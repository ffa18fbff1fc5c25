#include "evaluate/baseline_section.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

using files::MetricChange;
using Outcome = MetricChange::Outcome;

/// What a run depends on: where it changed, the numbers are of other things.
bool depends_on(const std::string& name) {
    for (const char* one : {".config_hash", ".dataset_hash", ".machine", ".program_version"})
        if (name.ends_with(one)) return true;
    return false;
}

std::vector<std::string> differences(const files::MetricFile& baseline, const files::MetricFile& results) {
    std::map<std::string, std::string> before;
    for (const files::MetricFile::Line& line : baseline.about) before[line.name] = line.value;
    std::vector<std::string> list;
    for (const files::MetricFile::Line& line : results.about) {
        const auto found = before.find(line.name);
        if (found != before.end() && found->second != line.value && depends_on(line.name))
            list.push_back(line.name + ": " + line.value + ", was " + found->second);
    }
    return list;
}

const char* outcome_name(Outcome outcome) {
    switch (outcome) {
        case Outcome::regressed:
            return "regressed";
        case Outcome::missing:
            return "missing";
        case Outcome::improved:
            return "improved";
        case Outcome::within:
            return "within";
        case Outcome::added:
            return "new";
        default:
            return "not judged";
    }
}

ReportTable table(const BaselineComparison& comparison) {
    using Align = ReportColumn::Align;
    ReportTable table{"baseline-table",
                      "Every metric that the baseline judges",
                      "Allowed: the largest of the tolerance, the noise of both intervals, and the simulator's noise.",
                      {{"metric", "", Align::text},
                       {"outcome", "", Align::text},
                       {"unit", "", Align::text},
                       {"better", "", Align::text},
                       {"baseline", "", Align::number, 4},
                       {"now", "", Align::number, 4},
                       {"change", "", Align::number, 3},
                       {"allowed", "", Align::number, 3}}};
    for (const MetricChange& change : comparison.changes) {
        if (change.outcome == Outcome::untold) continue;
        const files::Metric &before = change.baseline, &now = change.measured;
        const files::Metric& known = before.name.empty() ? now : before;
        table.rows.push_back({change.name(), outcome_name(change.outcome), known.unit,
                              files::direction_name(known.direction), Measured{before.value, before.low, before.high},
                              Measured{now.value, now.low, now.high}, now.value - before.value, change.allowed});
    }
    return table;
}

std::string metrics(int count) {
    return fmt::format("{} {}", count, count == 1 ? "metric" : "metrics");
}

}  // namespace

int BaselineComparison::count(Outcome outcome) const {
    return static_cast<int>(std::count_if(changes.begin(), changes.end(),
                                          [&](const MetricChange& change) { return change.outcome == outcome; }));
}

bool BaselineComparison::trips() const {
    return std::any_of(changes.begin(), changes.end(), [](const MetricChange& change) { return change.trips(); });
}

std::vector<std::string> BaselineComparison::lines() const {
    std::vector<std::string> list;
    for (const MetricChange& change : changes)
        if (change.trips()) list.push_back(change.line());
    return list;
}

BaselineComparison compare_with_baseline(const std::string& path, const files::MetricFile& results) {
    const files::MetricFile baseline = files::read_metric_file(path, "results");
    return {path, baseline.program_version, differences(baseline, results),
            files::compare_metrics(baseline.metric, results.metric)};
}

ReportSection baseline_section(const BaselineComparison& comparison) {
    ReportSection section{"baseline", "Against the baseline", {baseline_verdict(comparison)}};
    for (const std::string& difference : comparison.differences)
        section.text.push_back("Not the same as in the baseline: " + difference + ".");
    section.blocks.emplace_back(table(comparison));
    return section;
}

std::string baseline_verdict(const BaselineComparison& comparison) {
    const int regressed = comparison.count(Outcome::regressed), missing = comparison.count(Outcome::missing);
    const int improved = comparison.count(Outcome::improved), within = comparison.count(Outcome::within);
    const std::string against = fmt::format("Against the baseline {}", comparison.path);
    const std::string rest = fmt::format("{} improved, {} within what is allowed", improved, within);
    if (regressed + missing + improved + within == 0) return against + ": it judges no metric.";
    if (regressed + missing == 0) return fmt::format("{}: no regression; {}.", against, rest);
    return fmt::format("{}: {} regressed, {} not measured; {}.", against, metrics(regressed), missing, rest);
}

}  // namespace toile::evaluate
