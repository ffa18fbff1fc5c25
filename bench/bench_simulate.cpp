#include <CLI/CLI.hpp>
#include <iostream>

#include "bench/drape_results.h"
#include "bench/drape_rows.h"
#include "bench/program.h"

namespace {

using namespace toile::bench;

struct Flags {
    DrapeRowOptions rows;
    bool table = false;
    BaselineFiles baseline{{}, {}, "bench_simulate"};
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_flag("--table", flags.table, "measure and print the table, as Markdown; the default");
    app.add_option("--gate", flags.baseline.gate,
                   "measure and compare with this baseline; exit status 1 for a regression");
    app.add_option("--write-baseline", flags.baseline.written, "measure and write a baseline");
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
    return measure_against(
        flags.baseline,
        [&] {
            const DrapeResults results = measure_rows(flags.rows);
            print_drape_table(std::cout, results);
            return metrics(results);
        },
        std::cout);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_simulate", [&] { return run(argc, argv); });
}
