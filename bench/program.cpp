#include "bench/program.h"

#include <cstdio>
#include <exception>
#include <ostream>

#include "cloth/error.h"

namespace toile::bench {

int measure_against(const BaselineFiles& files, const std::function<std::vector<Metric>()>& measure,
                    std::ostream& out) {
    const std::vector<Metric> baseline = files.gate.empty() ? std::vector<Metric>{} : read_metrics(files.gate);
    const std::vector<Metric> measured = measure();
    if (!files.written.empty()) write_metrics(measured, files.written);
    const std::vector<std::string> worse = regressions(baseline, measured);
    for (const std::string& line : worse) out << "regression: " << line << '\n';
    if (!files.gate.empty() && worse.empty()) out << "gate: " << baseline.size() << " metrics, no regression\n";
    return worse.empty() ? 0 : 1;
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
