#include "evaluate/stability_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "evaluate/stability_picture.h"
#include "evaluate/stability_replay.h"
#include "evaluate/stability_results.h"
#include "evaluate/stability_tally.h"
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

std::string summary_line(const StabilityTally& of) {
    if (of.prior)
        return fmt::format(
            "{}: {} of {} cases passed; {} finite, {} of {} derivatives accurate, {} false claims; {:.1f} s\n",
            of.solver, of.passed, of.cases, of.finite, of.accurate_derivatives, of.derivatives, of.false_claims,
            of.seconds);
    return fmt::format(
        "{}: {} of {} cases passed; {} at rest within the gate, {} finite, energy never rose in {}; {:.1f} s\n",
        of.solver, of.passed, of.cases, of.rests, of.finite, of.falling, of.seconds);
}

std::string drape_lines(const std::vector<StabilityOutcome>& outcomes) {
    std::string text =
        fmt::format("{:<8} {:<6} {:<58} {:<22} {:<13} {:>9} {:>9} {:>9} {:>7} {:>6} {:>8}\n", "solver", "", "case",
                    "status", "energy", "residual", "speed m/s", "inside mm", "crosses", "steps", "seconds");
    for (const StabilityOutcome& one : outcomes) {
        if (one.prior) continue;
        const simulate::Certificate& c = one.certificate;
        text += fmt::format("{:<8} {:<6} {:<58} {:<22} {:<13} {:>9.1e} {:>9.1e} {:>9.2f} {:>7} {:>6} {:>8.2f}\n",
                            one.solver, one.passed() ? "passed" : "FAILED", one.name, one.status, energy_text(one),
                            c.residual_force, c.max_speed, 1e3 * c.body_penetration, c.self_intersections,
                            one.iterations, c.seconds);
    }
    return text;
}

std::string sample_lines(const std::vector<StabilityOutcome>& outcomes) {
    std::string text =
        fmt::format("{:<30} {:<14} {:>7} {:>7} {:>9} {:>11} {:>6} {:>6} {:>9} {:>9}\n", "prior", "prediction",
                    "samples", "passed", "worst/tol", "derivatives", "good", "false", "seconds", "slowest");
    for (const StabilityTally& of : tally_by_group(outcomes))
        if (of.prior)
            text += fmt::format("{:<30} {:<14} {:>7} {:>7} {:>9.2g} {:>11} {:>6} {:>6} {:>9.2f} {:>9.2f}\n", of.solver,
                                of.group, of.cases, of.passed, of.worst_residual, of.derivatives,
                                of.accurate_derivatives, of.false_claims, of.seconds, of.slowest);
    for (const StabilityOutcome& one : outcomes)
        if (one.prior && !one.passed())
            text += fmt::format("{:<30} {} {}; {}; residual {:.1e}, tolerance {:.0e}, {} steps\n", one.solver,
                                one.false_claim() ? "FALSE CLAIM" : "FAILED", one.name, one.status, one.residual(),
                                one.prior->tolerance, one.iterations);
    return text;
}

bool any_prior(const std::vector<StabilityOutcome>& outcomes, bool prior) {
    return std::any_of(outcomes.begin(), outcomes.end(),
                       [&](const StabilityOutcome& one) { return one.prior.has_value() == prior; });
}

std::vector<files::MetricFile::Line> about(const StabilityOptions& options) {
    std::string solvers;
    for (const std::string& solver : options.solver) solvers += (solvers.empty() ? "" : ", ") + solver;
    std::vector<files::MetricFile::Line> lines{{"solvers", solvers}};
    lines.push_back({"problems", fmt::format("{} of seed {}", options.priors.problems, options.priors.draw.seed)});
    if (!options.filter.empty()) lines.push_back({"filter", options.filter});
    if (options.quick) lines.push_back({"quick", "yes"});
    if (options.budget.iterations) lines.push_back({"iterations", std::to_string(*options.budget.iterations)});
    if (options.budget.tries) lines.push_back({"tries", std::to_string(*options.budget.tries)});
    return lines;
}

/// The picture of the drapes; none where there are none.
void draw(const std::string& path, const std::vector<StabilityOutcome>& outcomes) {
    std::vector<StabilityOutcome> drapes;
    for (const StabilityOutcome& one : outcomes)
        if (!one.prior) drapes.push_back(one);
    std::error_code ignored;
    if (drapes.empty())
        std::filesystem::remove(path, ignored);
    else
        files::write_png(path, stability_picture(drapes, solvers_of(drapes)));
}

}  // namespace

std::string stability_table(const std::vector<StabilityOutcome>& outcomes) {
    std::string text;
    if (any_prior(outcomes, false)) text += drape_lines(outcomes);
    if (any_prior(outcomes, true)) text += sample_lines(outcomes);
    for (const StabilityTally& of : tally_by_solver(outcomes)) text += summary_line(of);
    return text;
}

bool StabilitySummary::passed() const {
    return std::all_of(outcome.begin(), outcome.end(), [](const StabilityOutcome& one) { return one.passed(); });
}

StabilitySummary evaluate_stability(const StabilityOptions& options, const std::string& folder) {
    const generate::OutputFolder into(folder, generate::OutputFolder::For::results);
    StabilitySummary summary;
    const std::string csv = into.file("stability.csv"), json = into.file("stability.json"),
                      png = into.file("stability.png");
    StabilityOptions kept = options;
    kept.folder = folder;
    if (options.resume && std::filesystem::exists(json)) {
        try {
            kept.known = read_stability_results(json);
        } catch (const Error& error) {
            throw Error(std::string("nothing to resume from: ") + error.what(), error.where(),
                        "remove it, or leave out --resume");
        }
    }
    const auto write = [&](const std::vector<StabilityOutcome>& outcomes) {
        files::write_text_file(csv, stability_csv(outcomes));
        write_stability_results(json, outcomes, about(options));
    };
    kept.store = write;
    summary.outcome = run_stability(kept);
    write(summary.outcome);
    remove_other_replays(folder, summary.outcome);
    draw(png, summary.outcome);
    summary.path = {csv, json};
    if (std::filesystem::exists(png)) summary.path.push_back(png);
    return summary;
}

}  // namespace toile::evaluate
