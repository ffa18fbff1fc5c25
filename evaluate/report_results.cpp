#include "evaluate/report_results.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace toile::evaluate {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + "\"";
}

/// All digits that the number has.
std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string row(const files::Metric& metric) {
    const bool interval = !std::isnan(metric.low) || !std::isnan(metric.high);
    std::string line = quoted(metric.name);
    const auto add = [&line](const std::string& field) { line += "," + field; };
    add(number(metric.value));
    add(number(interval ? metric.low : metric.value));
    add(number(interval ? metric.high : metric.value));
    add(quoted(metric.unit));
    add(files::direction_name(metric.direction));
    add(number(metric.tolerance));
    add(std::to_string(metric.samples));
    const files::MetricDistribution none{files::Metric::missing, files::Metric::missing, files::Metric::missing,
                                         files::Metric::missing};
    const files::MetricDistribution& spread = metric.distribution ? *metric.distribution : none;
    for (const double one : {spread.median, spread.p95, spread.p99, spread.largest}) add(number(one));
    add(number(metric.floor.value_or(files::Metric::missing)));
    return line + "\n";
}

}  // namespace

files::MetricFile gathered_results(const std::vector<files::MetricFile>& evaluations) {
    files::MetricFile results;
    results.kind = "results";
    for (const files::MetricFile& one : evaluations) {
        results.about.push_back({one.kind + ".program_version", one.program_version});
        for (const files::MetricFile::Line& line : one.about)
            if (line.name != "program_version") results.about.push_back({one.kind + "." + line.name, line.value});
        results.metric.insert(results.metric.end(), one.metric.begin(), one.metric.end());
    }
    return results;
}

std::string results_csv(const files::MetricFile& results) {
    std::string text = "metric,value,low,high,unit,direction,tolerance,samples,median,p95,p99,largest,floor\n";
    for (const files::Metric& metric : results.metric) text += row(metric);
    return text;
}

}  // namespace toile::evaluate
