#include "bench/metrics.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth/error.h"

namespace toile::bench {

void write_metrics(const std::vector<Metric>& metrics, const std::string& file) {
    // ordered: a baseline is read and compared by people, too
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Metric& metric : metrics)
        list.push_back({{"key", metric.key},
                        {"value", metric.value},
                        {"unit", metric.unit},
                        {"direction", metric.lower_is_better ? "lower" : "higher"},
                        {"tolerance", metric.tolerance}});
    std::ofstream out(file);
    out << nlohmann::ordered_json{{"metrics", list}}.dump(2) << '\n';
    if (!out.flush()) throw Error("the metrics cannot be written", file);
}

std::vector<Metric> read_metrics(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw Error("the baseline cannot be read", file, "bench_prior --write-baseline FILE makes one");
    try {
        const nlohmann::json document = nlohmann::json::parse(in);
        std::vector<Metric> metrics;
        for (const auto& entry : document.at("metrics").get_ref<const nlohmann::json::array_t&>()) {
            const std::string direction = entry.at("direction");
            if (direction != "lower" && direction != "higher")
                throw Error("a direction is \"" + direction + "\": it must be \"lower\" or \"higher\"", file);
            metrics.push_back(
                {entry.at("key"), entry.at("value"), entry.at("unit"), direction == "lower", entry.at("tolerance")});
        }
        return metrics;
    } catch (const nlohmann::json::exception& error) {
        throw Error(std::string("the baseline is not a list of metrics: ") + error.what(), file);
    }
}

std::vector<std::string> regressions(const std::vector<Metric>& baseline, const std::vector<Metric>& measured) {
    std::vector<std::string> lines;
    for (const Metric& wanted : baseline) {
        const auto found = std::find_if(measured.begin(), measured.end(),
                                        [&](const Metric& metric) { return metric.key == wanted.key; });
        if (found == measured.end()) {
            lines.push_back(wanted.key + ": not measured");
            continue;
        }
        const double bound = wanted.value * (wanted.lower_is_better ? 1 + wanted.tolerance : 1 - wanted.tolerance);
        const bool good = wanted.lower_is_better ? found->value <= bound : found->value >= bound;
        if (good) continue;
        std::ostringstream line;
        line.precision(3);
        line << wanted.key << ": " << found->value << ' ' << wanted.unit << ", baseline " << wanted.value << ", bound "
             << bound;
        lines.push_back(line.str());
    }
    return lines;
}

}  // namespace toile::bench
