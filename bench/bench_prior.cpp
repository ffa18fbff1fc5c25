#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "bench/prior_benchmarks.h"
#include "bench/program.h"
#include "bench/speed_results.h"
#include "bench/speed_scene.h"
#include "bench/stress.h"
#include "bench/stress_report.h"
#include "cloth/error.h"

namespace {

using namespace toile::bench;

struct Flags {
    bool stress = false;
    StressDraw draw;
    int count = 10'000;
    int jobs = 1;
    int only = -1;
    std::string failures;

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
    app.add_flag("--stress", flags.stress,
                 "solve random problems and tell which fell short; exit status 1 if anything "
                 "claimed an accuracy that it does not have");
    app.add_option("--count", flags.count, "problems of the stress run")->check(CLI::PositiveNumber);
    app.add_option("--seed", flags.draw.seed, "what the problems are drawn from");
    app.add_option("--jobs", flags.jobs, "problems at a time")->check(CLI::PositiveNumber);
    app.add_option("--only", flags.only, "solve this problem alone")->check(CLI::NonNegativeNumber);
    app.add_option("--failures", flags.failures, "write the samples that fell short to this file, as JSON");
}

int stress(const Flags& flags) {
    const bool one = flags.only >= 0;
    const int first = one ? flags.only : 0, count = one ? 1 : flags.count;
    const auto outcome = run_stress(flags.draw, first, count, flags.jobs, [count](int done) {
        if (done % 500 == 0) std::fprintf(stderr, "%d of %d problems\n", done, count);
    });
    print_stress(std::cout, outcome);
    if (one)
        for (const StressOutcome& each : outcome)
            std::cout << "residual " << each.residual << ", steps " << each.iterations << ", " << each.seconds << " s; "
                      << each.description << '\n';
    if (!flags.failures.empty()) write_failures(outcome, flags.failures);
    return any_false_claim(outcome) ? 1 : 0;
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
        "Speed and stress of the two priors. Without a flag, or with --benchmark_..., Google Benchmark's own "
        "program.");
    add_flags(app, flags);
    app.allow_extras();
    CLI11_PARSE(app, argc, argv);
    if (!flags.stress && !flags.speed()) return plain(argc, argv);
    if (const auto extra = app.remaining(); !extra.empty()) throw toile::Error("unknown argument " + extra.front());
    return flags.stress ? stress(flags) : speed(flags, argv[0]);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_prior", [&] { return run(argc, argv); });
}
