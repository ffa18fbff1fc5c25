#include "evaluate/stability_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "evaluate/stability_picture.h"
#include "evaluate/stability_results.h"
#include "files/image_file.h"
#include "files/new_file.h"
#include "generate/output_folder.h"

namespace toile::evaluate {
namespace {

std::string energy_text(const StabilityOutcome& one) {
    if (std::isnan(one.energy_rise)) return "not measured";
    return one.falling ? "falls" : fmt::format("rose {:.0e} m", one.energy_rise);
}

/// Solvers in the order of their first case.
std::vector<std::string> solvers_of(const std::vector<StabilityOutcome>& outcomes) {
    std::vector<std::string> solver;
    for (const StabilityOutcome& one : outcomes)
        if (std::find(solver.begin(), solver.end(), one.solver) == solver.end()) solver.push_back(one.solver);
    return solver;
}

std::string summary_line(const std::vector<StabilityOutcome>& outcomes, const std::string& solver) {
    int cases = 0, passed = 0, rests = 0, finite = 0, falling = 0;
    double seconds = 0.0;
    for (const StabilityOutcome& one : outcomes) {
        if (one.solver != solver) continue;
        ++cases;
        passed += one.passed();
        rests += one.rests;
        finite += one.finite;
        falling += one.falling;
        seconds += one.certificate.seconds;
    }
    return fmt::format(
        "{}: {} of {} cases passed; {} at rest within the gate, {} finite, energy never rose in {}; {:.1f} s\n", solver,
        passed, cases, rests, finite, falling, seconds);
}

}  // namespace

std::string stability_table(const std::vector<StabilityOutcome>& outcomes) {
    std::string text =
        fmt::format("{:<8} {:<6} {:<58} {:<22} {:<13} {:>9} {:>9} {:>9} {:>7} {:>6} {:>8}\n", "solver", "", "case",
                    "status", "energy", "residual", "speed m/s", "inside mm", "crosses", "steps", "seconds");
    for (const StabilityOutcome& one : outcomes) {
        const simulate::Certificate& c = one.certificate;
        text += fmt::format("{:<8} {:<6} {:<58} {:<22} {:<13} {:>9.1e} {:>9.1e} {:>9.2f} {:>7} {:>6} {:>8.2f}\n",
                            one.solver, one.passed() ? "passed" : "FAILED", one.name, one.status, energy_text(one),
                            c.residual_force, c.max_speed, 1e3 * c.body_penetration, c.self_intersections,
                            one.iterations, c.seconds);
    }
    for (const std::string& solver : solvers_of(outcomes)) text += summary_line(outcomes, solver);
    return text;
}

bool StabilitySummary::passed() const {
    return std::all_of(outcome.begin(), outcome.end(), [](const StabilityOutcome& one) { return one.passed(); });
}

StabilitySummary evaluate_stability(const StabilityOptions& options, const std::string& folder) {
    const generate::OutputFolder into(folder, generate::OutputFolder::For::results);
    StabilitySummary summary;
    summary.path = {into.file("stability.csv"), into.file("stability.json"), into.file("stability.png")};
    StabilityOptions kept = options;
    if (options.resume && std::filesystem::exists(summary.path[1]))
        kept.known = read_stability_results(summary.path[1]);
    const auto write = [&](const std::vector<StabilityOutcome>& outcomes) {
        files::write_text_file(summary.path[0], stability_csv(outcomes));
        files::write_text_file(summary.path[1], stability_json(outcomes));
    };
    kept.store = write;
    summary.outcome = run_stability(kept);
    write(summary.outcome);
    files::write_png(summary.path[2], stability_picture(summary.outcome, solvers_of(summary.outcome)));
    return summary;
}

}  // namespace toile::evaluate
