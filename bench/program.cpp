#include "bench/program.h"

#include <cstdio>
#include <exception>
#include <ostream>

#include "cloth/error.h"
#include "files/metric_comparison.h"

namespace toile::bench {

int measure_against(const BaselineFiles& baseline, const std::function<std::vector<files::Metric>()>& measure,
                    std::ostream& out) {
    files::MetricFile before;
    if (!baseline.gate.empty()) before = files::read_metric_file(baseline.gate, baseline.kind);
    const std::vector<files::Metric> measured = measure();
    if (!baseline.written.empty()) files::write_metric_file(baseline.written, {baseline.kind, {}, {}, measured});
    int regressions = 0;
    for (const files::MetricChange& change : files::compare_metrics(before.metric, measured)) {
        if (!change.trips()) continue;
        ++regressions;
        out << "regression: " << change.line() << '\n';
    }
    if (!baseline.gate.empty() && regressions == 0)
        out << "gate: " << before.metric.size() << " metrics, no regression\n";
    return regressions == 0 ? 0 : 1;
}

int run_program(const char* name, const std::function<int()>& run) {
    try {
        return run();
    } catch (const Error& error) {
        const std::string where = error.where().empty() ? "" : " (" + error.where() + ")";
        std::fprintf(stderr, "%s: %s%s\n%s%s", name, error.what(), where.c_str(), error.mend().c_str(),
                     error.mend().empty() ? "" : "\n");
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return 1;
    }
}

}  // namespace toile::bench
