#include "bench/drape_results.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>

#include "bench/figures.h"

namespace toile::bench {
namespace {

bool starts_with(const std::string& text, const std::string& beginning) {
    return text.compare(0, beginning.size(), beginning) == 0;
}

/// The rows of a kind that were timed, by vertices.
std::vector<std::pair<std::string, const DrapeTiming*>> rows_of(const DrapeResults& results, const std::string& kind) {
    std::vector<std::pair<std::string, const DrapeTiming*>> rows;
    for (const auto& [name, timing] : results.timing)
        if (starts_with(name, kind) && timing.refused.empty()) rows.emplace_back(name, &timing);
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.second->vertices < b.second->vertices; });
    return rows;
}

void print_rows(std::ostream& out, const DrapeResults& results) {
    out << "| row | vertices | median s | 95 % s | median, factorisations | factorisation ms | iterations | accepted | "
           "error mm |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const char* kind : {"drape/", "solver/", "without/"})
        for (const auto& [name, row] : rows_of(results, kind))
            out << "| " << name << " | " << row->vertices << " | " << number(row->quantile_seconds(0.5)) << " | "
                << number(row->quantile_seconds(0.95)) << " | " << number(row->units()) << " | "
                << number(row->unit_milliseconds) << " | " << number(row->iterations) << " | "
                << number(100 * row->accepted_share) << " % of " << row->seconds.size() << " | "
                << number(1e3 * row->median_error()) << " |\n";
}

void print_stages(std::ostream& out, const DrapeResults& results) {
    std::set<std::string> stages;
    for (const auto& [name, row] : results.timing)
        for (const auto& [stage, seconds] : row.stage) stages.insert(stage);
    out << "\n| share of the time";
    for (const std::string& stage : stages) out << " | " << stage;
    out << " |\n|---";
    for (std::size_t k = 0; k < stages.size(); ++k) out << "|---";
    out << "|\n";
    for (const char* kind : {"drape/", "solver/", "without/"})
        for (const auto& [name, row] : rows_of(results, kind)) {
            double sum = 0.0;
            for (const auto& [stage, seconds] : row->stage) sum += seconds;
            out << "| " << name;
            for (const std::string& stage : stages) {
                const auto found = row->stage.find(stage);
                out << " | " << (found == row->stage.end() ? "" : number(100 * found->second / sum, 2) + " %");
            }
            out << " |\n";
        }
}

std::set<std::string> solvers(const DrapeResults& results) {
    std::set<std::string> names;
    for (const auto& [name, row] : results.timing)
        if (starts_with(name, "solver/")) names.insert(name.substr(7, name.find('/', 7) - 7));
    return names;
}

}  // namespace

double DrapeResults::exponent() const {
    const auto rows = rows_of(*this, "drape/");
    std::vector<std::pair<double, double>> points;
    for (const auto& [name, row] : rows) points.emplace_back(row->vertices, row->quantile_seconds(0.5));
    return scaling_exponent(points);
}

double DrapeResults::seconds_at_error(const std::string& solver, double error) const {
    std::vector<std::pair<double, double>> curve;  // of logarithms: error, seconds
    for (const auto& [name, row] : rows_of(*this, "solver/" + solver + "/"))
        if (row->median_error() > 0.0)
            curve.emplace_back(std::log(row->median_error()), std::log(row->quantile_seconds(0.5)));
    std::sort(curve.begin(), curve.end());
    const double wanted = std::log(error);
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        const auto& [low, slow] = curve[k];
        const auto& [high, fast] = curve[k + 1];
        if (wanted < low || wanted > high) continue;
        const double share = high > low ? (wanted - low) / (high - low) : 0.0;
        return std::exp(slow + share * (fast - slow));
    }
    return no_number;
}

void print_drape_table(std::ostream& out, const DrapeResults& results) {
    print_rows(out, results);
    print_stages(out, results);
    out << '\n';
    if (!std::isnan(results.exponent()))
        out << "exponent of time over vertices: " << number(results.exponent()) << '\n';
    for (const std::string& solver : solvers(results)) {
        const double seconds = results.seconds_at_error(solver, compared_error);
        out << solver << " at an error of " << 1e3 * compared_error
            << " mm: " << (std::isnan(seconds) ? "not between its settings' errors" : number(seconds) + " s") << '\n';
    }
    if (results.peak_memory > 0) out << "peak memory at 3,000 vertices: " << number(results.peak_memory, 4) << " MB\n";
    for (const auto& [name, timing] : results.timing)
        if (!timing.refused.empty()) out << "refused: " << name << ": " << timing.refused << '\n';
}

std::vector<files::Metric> metrics(const DrapeResults& results) {
    std::vector<files::Metric> list;
    for (const auto& [name, row] : results.timing) {
        if (!row.refused.empty()) continue;
        list.push_back(metric(name + "/median", row.units(), "factorisations", 0.25));
        list.push_back(metric(name + "/iterations", row.iterations, "iterations", 0.1));
        if (starts_with(name, "drape/")) {
            list.push_back(metric(name + "/percentile_95", 1e3 * row.quantile_seconds(0.95) / row.unit_milliseconds,
                                  "factorisations", 0.35));
            list.push_back(
                metric(name + "/accepted", row.accepted_share, "share", 0.0, files::MetricDirection::higher));
        }
        if (!row.error.empty()) list.push_back(metric(name + "/error", 1e3 * row.median_error(), "mm", 0.25));
    }
    if (!std::isnan(results.exponent())) list.push_back(metric("exponent", results.exponent(), "exponent", 0.1));
    if (results.peak_memory > 0) list.push_back(metric("memory", results.peak_memory, "MB", 0.1));
    return list;
}

}  // namespace toile::bench
