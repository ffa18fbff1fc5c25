#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>

#include "bench/stress.h"
#include "bench/stress_report.h"
#include "cloth/error.h"

namespace {

using namespace toile::bench;

struct StressFlags {
    StressDraw draw;
    int count = 10'000;
    int jobs = 1;
    int only = -1;
    std::string failures;
};

void add_stress_flags(CLI::App& app, StressFlags& flags) {
    app.add_option("--count", flags.count, "problems of the stress run")->check(CLI::PositiveNumber);
    app.add_option("--seed", flags.draw.seed, "what the problems are drawn from");
    app.add_option("--jobs", flags.jobs, "problems at a time")->check(CLI::PositiveNumber);
    app.add_option("--only", flags.only, "run this problem alone")->check(CLI::NonNegativeNumber);
    app.add_option("--failures", flags.failures, "write the samples that fell short to this file, as JSON");
}

int stress(const StressFlags& flags) {
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

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Speed and stress of the priors.");
    bool run_stress_flag = false;
    StressFlags stress_flags;
    app.add_flag("--stress", run_stress_flag, "random problems: how many meet their tolerance");
    add_stress_flags(app, stress_flags);
    CLI11_PARSE(app, argc, argv);
    try {
        if (run_stress_flag) return stress(stress_flags);
    } catch (const toile::Error& error) {
        std::fprintf(stderr, "bench_prior: %s%s%s%s\n", error.what(), error.where().empty() ? "" : " (",
                     error.where().c_str(), error.where().empty() ? "" : ")");
        return 2;
    }
    return 0;
}
