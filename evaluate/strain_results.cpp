#include "evaluate/strain_results.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;
using Figures = StrainFrameFigures::Surface;

constexpr int histogram_bins = 60;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

StrainQuantity& find(StrainSummary& summary, const std::string& name) {
    for (StrainQuantity& one : summary.quantity)
        if (one.name == name) return one;
    throw std::logic_error("no quantity " + name);
}

/// Tallies of one frame, and of all, of one component of the stretches.
template <typename Strain, typename Stretch>
QuantileTally tally(StrainSummary& summary, const std::string& name, const std::vector<Strain>& strain,
                    const Stretch& stretch) {
    StrainQuantity& whole = find(summary, name);
    QuantileTally frame;
    for (const Strain& one : strain) {
        if (!has_strain(one.fault)) continue;
        frame.add(stretch(one) - whole.origin);
        whole.tally.add(stretch(one) - whole.origin);
    }
    return frame;
}

void note_stretches(const QuantileTally& larger, const QuantileTally& smaller, Figures& figures) {
    figures.median_1 = 1 + larger.quantile(0.5);
    figures.p99_1 = 1 + larger.quantile(0.99);
    figures.largest_1 = 1 + larger.largest();
    figures.median_2 = 1 + smaller.quantile(0.5);
    figures.p1_2 = 1 + smaller.quantile(0.01);
    figures.smallest_2 = 1 + smaller.smallest();
    figures.largest_rate = figures.largest_spin = figures.largest_error = std::numeric_limits<double>::quiet_NaN();
}

template <typename Strain>
void count_faults(const std::vector<Strain>& strain, FaultCounts& frame, FaultCounts& all) {
    for (const Strain& one : strain) {
        ++frame[static_cast<size_t>(one.fault)];
        ++all[static_cast<size_t>(one.fault)];
    }
}

/// Returns how many are missing.
std::int64_t add_rates(StrainSummary& summary, const std::string& where, const std::vector<StrainRate>& rates,
                       Figures& figures) {
    StrainQuantity &first = find(summary, where + "/rate_1"), &second = find(summary, where + "/rate_2"),
                   &spin = find(summary, where + "/spin"), &error = find(summary, where + "/rate_error");
    std::int64_t missing = 0;
    const auto raise = [](double& largest, double value) {
        if (std::isfinite(value)) largest = std::isnan(largest) ? value : std::max(largest, value);
    };
    for (const StrainRate& one : rates) {
        if (!one.is_finite()) {
            ++missing;
            continue;
        }
        first.tally.add(one.rate[0]);
        second.tally.add(one.rate[1]);
        spin.tally.add(one.spin.norm());
        error.tally.add(one.error);
        raise(figures.largest_rate, one.rate.cwiseAbs().maxCoeff());
        raise(figures.largest_spin, one.spin.norm());
        raise(figures.largest_error, one.error);
    }
    figures.rates_missing = missing;
    return missing;
}

Json fault_json(const FaultCounts& count) {
    Json out = Json::object();
    for (int k = 1; k < strain_fault_count; ++k) out[strain_fault_name(static_cast<StrainFault>(k))] = count[k];
    return out;
}

Json figures_json(const Figures& one, bool rates) {
    Json out{{"stretch_1",
              {{"median", number(one.median_1)}, {"p99", number(one.p99_1)}, {"largest", number(one.largest_1)}}},
             {"stretch_2",
              {{"median", number(one.median_2)}, {"p1", number(one.p1_2)}, {"smallest", number(one.smallest_2)}}},
             {"faults", fault_json(one.fault)}};
    if (!rates) return out;
    out["largest_rate"] = number(one.largest_rate);
    out["largest_spin"] = number(one.largest_spin);
    out["largest_rate_error"] = number(one.largest_error);
    out["rates_missing"] = one.rates_missing;
    return out;
}

Json quantity_json(const StrainQuantity& one) {
    QuantileTally::Histogram histogram = one.tally.histogram(histogram_bins);
    for (double& edge : histogram.edges) edge += one.origin;
    return {{"name", one.name},
            {"unit", one.unit},
            {"count", one.tally.count()},
            {"not_there", one.tally.not_finite()},
            {"mean", number(one.origin + one.tally.mean())},
            {"smallest", number(one.origin + one.tally.smallest())},
            {"p1", number(one.quantile(0.01))},
            {"p5", number(one.quantile(0.05))},
            {"median", number(one.quantile(0.5))},
            {"p95", number(one.quantile(0.95))},
            {"p99", number(one.quantile(0.99))},
            {"largest", number(one.origin + one.tally.largest())},
            {"histogram", {{"edges", histogram.edges}, {"counts", histogram.counts}}}};
}

files::Metric metric_of(const StrainQuantity& one, int frames) {
    files::Metric metric;
    metric.name = "strain/" + one.name;
    metric.value = one.quantile(0.5);
    metric.unit = one.unit;
    metric.samples = frames;
    if (one.tally.count() > 0)
        metric.distribution = {metric.value, one.quantile(0.95), one.quantile(0.99), one.origin + one.tally.largest()};
    return metric;
}

/// How much shorter the shortest direction is: its far end is that of the smallest stretch.
files::Metric compression_of(const StrainQuantity& smallest, const std::string& name, int frames) {
    files::Metric metric;
    metric.name = name;
    metric.value = 1 - smallest.quantile(0.5);
    metric.unit = "1";
    metric.samples = frames;
    if (smallest.tally.count() > 0)
        metric.distribution = {metric.value, 1 - smallest.quantile(0.05), 1 - smallest.quantile(0.01),
                               -smallest.tally.smallest()};
    return metric;
}

files::Metric count_metric(const std::string& name, std::int64_t count, int frames) {
    files::Metric metric;
    metric.name = name;
    metric.value = static_cast<double>(count);
    metric.unit = "count";
    metric.direction = files::MetricDirection::lower;
    metric.tolerance = 0;
    metric.samples = frames;
    return metric;
}

void add_counts(std::vector<files::Metric>& out, const std::string& where, const FaultCounts& count,
                const std::vector<StrainFault>& possible, int frames) {
    for (const StrainFault fault : possible) {
        std::string name = strain_fault_name(fault);
        std::replace(name.begin(), name.end(), ' ', '_');
        out.push_back(count_metric("strain/" + where + "/" + name, count[static_cast<size_t>(fault)], frames));
    }
}

/// "3 collapsed, 1 inverted", empty of none
std::string fault_text(const FaultCounts& count) {
    std::string text;
    for (int k = 1; k < strain_fault_count; ++k)
        if (count[k] > 0)
            text += (text.empty() ? "" : ", ") + std::to_string(count[k]) + " " +
                    strain_fault_name(static_cast<StrainFault>(k));
    return text;
}

}  // namespace

const StrainQuantity& StrainSummary::of(const std::string& name) const {
    return find(const_cast<StrainSummary&>(*this), name);
}

StrainSummary empty_summary(bool rates, int triangles, int vertices) {
    StrainSummary summary;
    summary.rates = rates;
    summary.triangles = triangles;
    summary.vertices = vertices;
    for (const char* name : {"triangle/stretch_1", "triangle/stretch_2", "vertex/surface_stretch_1",
                             "vertex/surface_stretch_2", "vertex/stretch_1", "vertex/stretch_2", "vertex/stretch_3"})
        summary.quantity.push_back({name, "1", 1.0, {}});
    summary.quantity.push_back({"vertex/residual", "1", 0.0, {}});
    if (!rates) return summary;
    for (const char* where : {"triangle", "vertex"})
        for (const auto& [name, unit] : {std::pair("/rate_1", "1/s"), std::pair("/rate_2", "1/s"),
                                         std::pair("/spin", "rad/s"), std::pair("/rate_error", "1/s")})
            summary.quantity.push_back({std::string(where) + name, unit, 0.0, {}});
    return summary;
}

void add_frame(StrainSummary& summary, const std::string& name, const std::vector<TriangleStrain>& triangle,
               const std::vector<VertexStrain>& vertex) {
    StrainFrameFigures& frame = summary.frame.emplace_back();
    frame.name = name;
    const auto component = [](int k) { return [k](const auto& one) { return one.stretch[k]; }; };
    const auto surface = [](int k) { return [k](const VertexStrain& one) { return one.surface_stretch[k]; }; };
    const QuantileTally first = tally(summary, "triangle/stretch_1", triangle, component(0));
    note_stretches(first, tally(summary, "triangle/stretch_2", triangle, component(1)), frame.triangle);
    const QuantileTally larger = tally(summary, "vertex/surface_stretch_1", vertex, surface(0));
    note_stretches(larger, tally(summary, "vertex/surface_stretch_2", vertex, surface(1)), frame.vertex);
    for (int k = 0; k < 3; ++k) tally(summary, "vertex/stretch_" + std::to_string(k + 1), vertex, component(k));
    tally(summary, "vertex/residual", vertex, [](const VertexStrain& one) { return one.residual; });
    count_faults(triangle, frame.triangle.fault, summary.triangle_fault);
    count_faults(vertex, frame.vertex.fault, summary.vertex_fault);
}

void add_rates(StrainSummary& summary, int k, const std::vector<StrainRate>& triangle,
               const std::vector<StrainRate>& vertex) {
    StrainFrameFigures& frame = summary.frame.at(k);
    summary.triangle_rates_missing += add_rates(summary, "triangle", triangle, frame.triangle);
    summary.vertex_rates_missing += add_rates(summary, "vertex", vertex, frame.vertex);
}

std::vector<files::Metric> strain_metrics(const StrainSummary& summary) {
    const int frames = static_cast<int>(summary.frame.size());
    std::vector<files::Metric> out;
    for (const StrainQuantity& one : summary.quantity) out.push_back(metric_of(one, frames));
    out.push_back(compression_of(summary.of("triangle/stretch_2"), "strain/triangle/compression", frames));
    out.push_back(compression_of(summary.of("vertex/surface_stretch_2"), "strain/vertex/surface_compression", frames));
    using enum StrainFault;
    add_counts(out, "triangle", summary.triangle_fault, {degenerate_rest, collapsed, inverted, overflow}, frames);
    add_counts(out, "vertex", summary.vertex_fault, {too_few, low_rank, no_normal, collapsed, inverted, overflow},
               frames);
    if (!summary.rates) return out;
    out.push_back(count_metric("strain/triangle/rates_missing", summary.triangle_rates_missing, frames));
    out.push_back(count_metric("strain/vertex/rates_missing", summary.vertex_rates_missing, frames));
    return out;
}

Json strain_members(const StrainSummary& summary) {
    Json frames = Json::array(), quantities = Json::array();
    for (const StrainFrameFigures& one : summary.frame)
        frames.push_back({{"name", one.name},
                          {"triangle", figures_json(one.triangle, summary.rates)},
                          {"vertex", figures_json(one.vertex, summary.rates)}});
    for (const StrainQuantity& one : summary.quantity) quantities.push_back(quantity_json(one));
    return {
        {"rates", summary.rates},
        {"triangles", summary.triangles},
        {"vertices", summary.vertices},
        {"faults", {{"triangle", fault_json(summary.triangle_fault)}, {"vertex", fault_json(summary.vertex_fault)}}},
        {"notes", summary.note},
        {"quantity", quantities},
        {"frames", frames}};
}

std::string strain_table(const StrainSummary& summary) {
    std::string text = fmt::format("{:<26} {:>6} {:>11} {:>11} {:>11} {:>11} {:>11}\n", "", "unit", "smallest", "p1",
                                   "median", "p99", "largest");
    for (const StrainQuantity& one : summary.quantity)
        text += fmt::format("{:<26} {:>6} {:>11.5g} {:>11.5g} {:>11.5g} {:>11.5g} {:>11.5g}\n", one.name, one.unit,
                            one.origin + one.tally.smallest(), one.quantile(0.01), one.quantile(0.5),
                            one.quantile(0.99), one.origin + one.tally.largest());
    text += fmt::format("{} frames of {} triangles and {} vertices\n", summary.frame.size(), summary.triangles,
                        summary.vertices);
    const std::string triangle = fault_text(summary.triangle_fault), vertex = fault_text(summary.vertex_fault);
    if (!triangle.empty()) text += "triangles, over all frames: " + triangle + "\n";
    if (!vertex.empty()) text += "vertices, over all frames: " + vertex + "\n";
    if (summary.triangle_rates_missing + summary.vertex_rates_missing > 0)
        text += fmt::format("without rates, as a frame needed for them has no values: {} triangles, {} vertices\n",
                            summary.triangle_rates_missing, summary.vertex_rates_missing);
    for (const std::string& note : summary.note) text += note + "\n";
    return text;
}

}  // namespace toile::evaluate
