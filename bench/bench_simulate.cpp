#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>

#include "bench/drape_results.h"
#include "bench/drape_rows.h"
#include "cloth/error.h"

namespace {

using namespace toile::bench;

struct Flags {
    DrapeRowOptions rows;
    bool table = false;
    std::string gate, write_baseline;
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_flag("--table", flags.table, "measure and print the table, as Markdown; the default");
    app.add_option("--gate", flags.gate, "measure and compare with this baseline; exit status 1 for a regression");
    app.add_option("--write-baseline", flags.write_baseline, "measure and write a baseline");
    app.add_option("--filter", flags.rows.filter,
                   "rows to measure, as a regular expression: drape/3000, solver/, memory");
    app.add_option("--poses", flags.rows.poses, "drapes a row")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_flag("--large", flags.rows.large, "also about 25,000 vertices");
}

int run(int argc, char** argv) {
    Flags flags;
    CLI::App app(
        "Speed of the simulator: drapes of the built-in T-shirt over the whole range of the arms, by size and stage; "
        "the\n"
        "three solvers at equal error; what a scene saves without a body or without self-contact. Processor time.");
    add_flags(app, flags);
    CLI11_PARSE(app, argc, argv);
    const std::vector<Metric> baseline = flags.gate.empty() ? std::vector<Metric>{} : read_metrics(flags.gate);
    const DrapeResults results = measure_rows(flags.rows);
    print_drape_table(std::cout, results);
    if (!flags.write_baseline.empty()) write_metrics(metrics(results), flags.write_baseline);
    const std::vector<std::string> worse = regressions(baseline, metrics(results));
    for (const std::string& line : worse) std::cout << "regression: " << line << '\n';
    if (!flags.gate.empty() && worse.empty()) std::cout << "gate: " << baseline.size() << " metrics, no regression\n";
    return worse.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const toile::Error& error) {
        const std::string where = error.where().empty() ? "" : " (" + error.where() + ")";
        std::fprintf(stderr, "bench_simulate: %s%s\n%s%s", error.what(), where.c_str(), error.mend().c_str(),
                     error.mend().empty() ? "" : "\n");
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_simulate: %s\n", error.what());
        return 1;
    }
}
