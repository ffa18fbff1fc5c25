#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "bench/prior_benchmarks.h"
#include "bench/program.h"
#include "bench/speed_results.h"
#include "bench/speed_scene.h"
#include "cloth/error.h"

namespace {

using namespace toile::bench;

struct Flags {
    bool table = false;
    std::string filter = "all";
    BaselineFiles baseline{{}, {}, "bench_prior"};
    int repetitions = 5;

    bool speed() const { return table || !baseline.gate.empty() || !baseline.written.empty(); }
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_flag("--table", flags.table, "measure and print the speed table, as Markdown");
    app.add_option("--gate", flags.baseline.gate,
                   "measure and compare with this baseline; exit status 1 for a regression");
    app.add_option("--write-baseline", flags.baseline.written, "measure and write a baseline");
    app.add_option("--filter", flags.filter, "rows to measure, as a regular expression; the units always are");
    app.add_option("--repetitions", flags.repetitions, "of each row; the least counts")->check(CLI::PositiveNumber);
}

SpeedResults measure(const Flags& flags, const char* program) {
    SpeedResults results;
    // first, while this process is small
    results.peak_memory = peak_memories();
    results.overstretched_share = speed_scene(table_around, table_along, table_batch).overstretched_share();
    register_prior_benchmarks(flags.repetitions);
    TimingCollector collector(results.timing);
    const std::string rows = flags.filter == "all" ? "-^scaling/" : "^unit/|" + flags.filter;
    const auto run = [&](const char* program_flag, const std::string& spec) {
        std::string name = program, interleave = program_flag;
        char* arguments[] = {name.data(), interleave.data(), nullptr};
        int count = 2;
        benchmark::Initialize(&count, arguments);
        benchmark::RunSpecifiedBenchmarks(&collector, spec);
    };
    // interleaved: a busy spell of the machine hits units and rows alike
    run("--benchmark_enable_random_interleaving=true", rows);
    // by size, one in memory at a time
    if (flags.filter == "all") run("--benchmark_enable_random_interleaving=false", "^scaling/");
    return results;
}

int speed(const Flags& flags, const char* program) {
    return measure_against(
        flags.baseline,
        [&] {
            const SpeedResults results = measure(flags, program);
            print_speed_table(std::cout, results);
            return metrics(results);
        },
        std::cout);
}

/// Without a flag of ours: Google Benchmark's own program, with its flags.
int plain(int argc, char** argv) {
    register_prior_benchmarks(1);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

int run(int argc, char** argv) {
    Flags flags;
    CLI::App app(
        "Speed of the two priors. Without a flag, or with --benchmark_..., Google Benchmark's own "
        "program.");
    add_flags(app, flags);
    app.allow_extras();
    CLI11_PARSE(app, argc, argv);
    if (!flags.speed()) return plain(argc, argv);
    if (const auto extra = app.remaining(); !extra.empty()) throw toile::Error("unknown argument " + extra.front());
    return speed(flags, argv[0]);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_prior", [&] { return run(argc, argv); });
}
