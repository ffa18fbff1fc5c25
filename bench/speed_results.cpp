#include "bench/speed_results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <sstream>

#include "bench/figures.h"

namespace toile::bench {
namespace {

bool starts_with(const std::string& text, const std::string& start) {
    return text.compare(0, start.size(), start) == 0;
}

/// The parts of a name between slashes.
std::vector<std::string> parts_of(const std::string& name) {
    std::vector<std::string> parts;
    std::istringstream stream(name);
    for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
    return parts;
}

/// The targets for the default methods, in units; NaN where it names none. One sample alone may take three
/// times what it takes in a batch.
double target(const std::vector<std::string>& row) {
    const bool is_default = row[1] == "interior_point" || row[1] == "fast";
    if (!is_default || row[4] == "warm") return no_number;
    const bool loose = row[0] == "quasistatic" || row[2] == "1e-4";
    return (row[4] == "alone" ? 3 : 1) * (row[3] == "backward" ? 0.1 : loose ? 0.4 : 1.0);
}

}  // namespace

double SpeedResults::units(const std::string& row) const {
    const auto one = timing.find("unit/cholmod_default"), found = timing.find(row);
    if (one == timing.end() || found == timing.end() || !one->second.refused.empty() || !found->second.refused.empty())
        return no_number;
    return found->second.milliseconds / one->second.milliseconds;
}

double SpeedResults::exponent(const std::string& name) const {
    std::vector<std::pair<double, double>> points;
    for (const auto& [key, row] : timing)
        if (starts_with(key, "scaling/" + name + "/") && row.refused.empty())
            points.emplace_back(std::stod(parts_of(key).back()), row.milliseconds);
    return scaling_exponent(points);
}

bool TimingCollector::ReportContext(const Context&) {
    return true;
}

void TimingCollector::ReportRuns(const std::vector<Run>& runs) {
    for (const Run& run : runs) {
        if (run.run_type != Run::RT_Iteration) continue;
        const std::string& name = run.run_name.function_name;
        const auto [place, is_new] = timing_.try_emplace(name);
        Timing& timing = place->second;
        if (run.error_occurred) {
            timing.refused = run.error_message;
            std::fprintf(stderr, "%s: refused: %s\n", name.c_str(), run.error_message.c_str());
            continue;
        }
        const double time = run.GetAdjustedCPUTime() / run.counters.at("samples");
        timing.milliseconds = is_new ? time : std::min(time, timing.milliseconds);
        timing.iterations = run.counters.at("iterations");
        timing.label = run.report_label;
        std::fprintf(stderr, "%s: %.3f ms\n", name.c_str(), time);
    }
}

namespace {

void print_rows(std::ostream& out, const SpeedResults& results) {
    out << "| prior | method | tolerance | what | how | units | target | ms | steps |\n"
           "|---|---|---|---|---|---|---|---|---|\n";
    for (const auto& [name, timing] : results.timing) {
        const std::vector<std::string> row = parts_of(name);
        if (row.size() != 5) continue;
        out << "| ";
        for (const std::string& part : row) out << part << " | ";
        if (!timing.refused.empty()) {
            out << "refused | | | |\n";
            continue;
        }
        out << number(results.units(name)) << " | " << number(target(row)) << " | " << number(timing.milliseconds)
            << " | " << (timing.iterations > 0 ? number(timing.iterations) : "") << " |\n";
    }
}

void print_scaling(std::ostream& out, const SpeedResults& results) {
    std::map<std::string, std::map<int, const Timing*>> curves;
    for (const auto& [key, timing] : results.timing) {
        const std::vector<std::string> parts = parts_of(key);
        if (parts[0] == "scaling") curves[parts[1] + "/" + parts[2]][std::stoi(parts[3])] = &timing;
    }
    for (const auto& [name, curve] : curves) {
        out << "\n| " << name;
        for (const auto& [vertices, timing] : curve) out << " | " << vertices;
        out << " | exponent |\n|---";
        for (std::size_t k = 0; k <= curve.size(); ++k) out << "|---";
        out << "|\n| ms a sample";
        for (const auto& [vertices, timing] : curve)
            out << " | " << (timing->refused.empty() ? number(timing->milliseconds) : "refused");
        out << " | " << number(results.exponent(name)) << " |\n| steps";
        for (const auto& [vertices, timing] : curve)
            out << " | " << (timing->iterations > 0 ? number(timing->iterations) : "");
        out << " | |\n";
    }
}

}  // namespace

void print_speed_table(std::ostream& out, const SpeedResults& results) {
    for (const auto& [name, timing] : results.timing)
        if (starts_with(name, "unit/"))
            out << name.substr(5) << ": " << number(timing.milliseconds) << " ms (" << timing.label << ")\n";
    out << "overstretched edges: " << number(100 * results.overstretched_share) << " %\n\n";
    print_rows(out, results);
    print_scaling(out, results);
    out << '\n';
    for (const auto& [prior, memory] : results.peak_memory)
        out << "peak memory of a batch of 64, " << prior << ": " << number(memory, 4) << " MB\n";
    for (const auto& [name, timing] : results.timing)
        if (!timing.refused.empty()) out << "refused: " << name << ": " << timing.refused << '\n';
}

std::vector<files::Metric> metrics(const SpeedResults& results) {
    std::vector<files::Metric> list;
    for (const auto& [name, timing] : results.timing) {
        if (!timing.refused.empty() || parts_of(name).size() != 5) continue;
        list.push_back(metric(name, results.units(name), "factorisations", 0.25));
        if (timing.iterations > 0) list.push_back(metric(name + "/steps", timing.iterations, "iterations", 0.1));
    }
    for (const std::string name :
         {"inextensibility/forward", "inextensibility/backward", "quasistatic/forward", "quasistatic/backward"})
        if (const double exponent = results.exponent(name); !std::isnan(exponent))
            list.push_back(metric("scaling/" + name, exponent, "exponent", 0.1));
    for (const auto& [prior, memory] : results.peak_memory)
        if (memory > 0) list.push_back(metric("memory/" + prior, memory, "MB", 0.1));
    return list;
}

}  // namespace toile::bench
