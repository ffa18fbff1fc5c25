#include "evaluate/noise_results.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "evaluate/noise_histogram.h"
#include "files/metric_file.h"
#include "simulate/certificate.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string reason(int status) {
    return std::string(simulate::status_reason(static_cast<simulate::DrapeStatus>(status)));
}

/// The value that a share of all lie at or below; NaN of none. Changes their order.
double quantile(std::vector<double>& value, double share) {
    if (value.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto place = value.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(value.size() - 1));
    std::nth_element(value.begin(), place, value.end());
    return *place;
}

Json as_json(const NoiseStatistics& one) {
    return {{"name", one.name},
            {"samples", one.samples},
            {"accepted", one.accepted},
            {"median", number(one.median)},
            {"percentile_95", number(one.percentile_95)},
            {"percentile_99", number(one.percentile_99)},
            {"largest", number(one.largest)},
            {"root_mean_square", number(one.root_mean_square)},
            {"seconds_a_drape", number(one.seconds)}};
}

/// Of one variant, or of the spread.
void add_metrics(const NoiseStatistics& one, int drapes, std::vector<files::Metric>& metric) {
    constexpr double repeatable = 0.25;  // other poses, another machine's rounding: a drape is chaotic
    files::Metric distance;
    distance.name = "noise/" + one.name + "/distance";
    distance.value = 1e3 * one.root_mean_square;
    distance.unit = "mm";
    distance.direction = files::MetricDirection::lower;
    distance.tolerance = repeatable;
    distance.samples = one.samples;
    distance.distribution = {{1e3 * one.median, 1e3 * one.percentile_95, 1e3 * one.percentile_99, 1e3 * one.largest}};
    metric.push_back(distance);
    if (drapes == 0) return;
    files::Metric accepted;
    accepted.name = "noise/" + one.name + "/accepted_share";
    accepted.value = 100.0 * one.accepted / drapes;
    accepted.unit = "%";
    accepted.direction = files::MetricDirection::higher;
    accepted.samples = drapes;
    metric.push_back(accepted);
    files::Metric seconds;
    seconds.name = "noise/" + one.name + "/seconds";
    seconds.value = one.seconds;
    seconds.unit = "s";
    seconds.samples = drapes;
    metric.push_back(seconds);
}

files::MetricFile metrics_of(const NoiseSummary& summary, const generate::SceneConfig& config) {
    files::MetricFile file;
    file.kind = "noise";
    file.about = {{"source", config.file}, {"config_hash", config.hash}};
    for (const NoiseStatistics& one : summary.variant) add_metrics(one, summary.samples, file.metric);
    add_metrics(summary.spread, 0, file.metric);
    return file;
}

}  // namespace

NoiseStatistics NoiseResults::Pairs::statistics(int drapes) const {
    NoiseStatistics result;
    result.name = name;
    result.samples = samples;
    result.accepted = accepted;
    result.seconds = drapes > 0 ? seconds / drapes : 0.0;
    std::vector<double> sorted = distance;
    result.median = quantile(sorted, 0.5);
    result.percentile_95 = quantile(sorted, 0.95);
    result.percentile_99 = quantile(sorted, 0.99);
    result.largest = quantile(sorted, 1.0);
    double sum = 0.0;
    for (const double one : distance) sum += one * one;
    result.root_mean_square = std::sqrt(sum / static_cast<double>(distance.size()));
    return result;
}

NoiseResults::NoiseResults(const std::vector<files::NoiseVariant>& variant) {
    configured_.name = "configured";
    spread_.name = "spread";
    for (const files::NoiseVariant& one : variant) variant_.emplace_back().name = one.name;
}

void NoiseResults::add(const files::NoiseRecord& record, const std::vector<double>& seconds) {
    const auto take = [](Pairs& pairs, const Eigen::VectorXd& distance) {
        ++pairs.samples;
        pairs.distance.insert(pairs.distance.end(), distance.data(), distance.data() + distance.size());
    };
    Sample sample{record.id, record.status, {}, record.spread_rms, record.spread_max};
    configured_.seconds += seconds[0];
    if (record.status == 0) ++configured_.accepted;
    for (size_t k = 0; k < variant_.size(); ++k) {
        const files::NoiseRecord::Variant& one = record.variant[k];
        variant_[k].seconds += seconds[k + 1];
        if (one.status == 0) ++variant_[k].accepted;
        if (one.status == 0 && record.status == 0) take(variant_[k], one.distance);
        sample.variant_status.push_back(one.status);
    }
    if (record.spread.allFinite()) take(spread_, record.spread);
    sample_.push_back(std::move(sample));
}

void NoiseResults::summarise(NoiseSummary& summary) const {
    const int drapes = static_cast<int>(sample_.size());
    summary.configured = configured_.accepted;
    summary.configured_seconds = drapes > 0 ? configured_.seconds / drapes : 0.0;
    for (const Pairs& pairs : variant_) summary.variant.push_back(pairs.statistics(drapes));
    summary.spread = spread_.statistics(0);
}

void NoiseResults::write(const NoiseSummary& summary, const files::NoiseHeader& header,
                         const generate::SceneConfig& config) const {
    Json variants = Json::array(), samples = Json::array();
    for (size_t k = 0; k < variant_.size(); ++k) {
        variants.push_back(as_json(summary.variant[k]));
        variants.back()["what"] = header.variant[k].what;
    }
    for (const Sample& one : sample_) {
        Json row{{"id", one.id}, {"status", reason(one.status)}};
        for (size_t k = 0; k < variant_.size(); ++k) row[variant_[k].name] = reason(one.variant_status[k]);
        row["spread_rms"] = number(one.rms);
        row["spread_max"] = number(one.largest);
        samples.push_back(std::move(row));
    }
    std::vector<NamedDistances> distances;
    for (const Pairs& pairs : variant_) distances.push_back({pairs.name, &pairs.distance});
    distances.push_back({spread_.name, &spread_.distance});
    const Json own{{"config_hash", config.hash},
                   {"unit", "metres"},
                   {"share", header.share},
                   {"poses", summary.poses},
                   {"vertices", summary.vertices},
                   {"configured_accepted", summary.configured},
                   {"configured_seconds_a_drape", number(summary.configured_seconds)},
                   {"spread", as_json(summary.spread)},
                   {"variants", variants},
                   {"missing", summary.missing},
                   {"histogram", noise_histogram(distances)},
                   {"samples", samples}};
    files::write_metric_file(summary.results, metrics_of(summary, config), own);
}

std::string noise_table(const NoiseSummary& s) {
    std::string text = fmt::format("{:<16} {:>9} {:>9} {:>10} {:>10} {:>10} {:>11}\n", "distance, mm", "accepted",
                                   "compared", "median", "95 %", "largest", "s a drape");
    text += fmt::format("{:<16} {:>9} {:>9} {:>10} {:>10} {:>10} {:>11.2f}\n", "configured", s.configured, "", "", "",
                        "", s.configured_seconds);
    const auto line = [&](const NoiseStatistics& one, const std::string& accepted, const std::string& seconds) {
        text += fmt::format("{:<16} {:>9} {:>9} {:>10.4f} {:>10.4f} {:>10.4f} {:>11}\n", one.name, accepted,
                            one.samples, 1e3 * one.median, 1e3 * one.percentile_95, 1e3 * one.largest, seconds);
    };
    for (const NoiseStatistics& one : s.variant)
        line(one, std::to_string(one.accepted), fmt::format("{:.2f}", one.seconds));
    line(s.spread, "", "");
    for (const std::string& one : s.missing) text += one + "\n";
    return text;
}

}  // namespace toile::evaluate
