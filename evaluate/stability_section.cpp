#include "evaluate/stability_section.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include "evaluate/stability_results.h"
#include "evaluate/stability_tally.h"

namespace toile::evaluate {
namespace {

constexpr std::size_t most_passed = 1000;
constexpr auto text = ReportColumn::Align::text;
constexpr auto figure = ReportColumn::Align::number;

ReportTable by_solver(const std::vector<StabilityOutcome>& outcomes) {
    ReportTable table{"stability-solvers", "By solver", "", {{"solver", "", text}}};
    for (const char* name : {"cases", "passed", "finite", "false claims", "derivatives tried", "accurate"})
        table.columns.push_back({name, "", figure, 6});
    table.columns.push_back({"time", "s", figure, 3});
    table.columns.push_back({"slowest", "s", figure, 3});
    for (const StabilityTally& of : tally_by_solver(outcomes)) {
        const auto of_prior = [&](int count) { return of.prior ? ReportCell(count) : ReportCell(); };
        table.rows.push_back({of.solver, of.cases, of.passed, of.finite, of_prior(of.false_claims),
                              of_prior(of.derivatives), of_prior(of.accurate_derivatives), of.seconds, of.slowest});
    }
    return table;
}

std::string verdict(const StabilityOutcome& one) {
    if (one.passed()) return "passed";
    if (!one.available()) return "not available";
    return one.false_claim() ? "false claim" : "failed";
}

std::vector<ReportCell> row_of(const StabilityOutcome& one) {
    return {verdict(one),
            one.solver,
            one.group,
            one.name,
            one.status,
            one.residual(),
            one.prior ? ReportCell(one.prior->tolerance) : ReportCell(),
            one.prior && one.prior->derivative_checked ? ReportCell(one.prior->identity_error) : ReportCell(),
            one.vertices,
            one.iterations,
            one.certificate.seconds,
            one.replay};
}

ReportTable by_case(std::vector<StabilityOutcome> outcomes) {
    std::stable_sort(outcomes.begin(), outcomes.end(), [](const auto& one, const auto& other) {
        return std::pair(one.passed(), !one.false_claim()) < std::pair(other.passed(), !other.false_claim());
    });
    ReportTable table{"stability-cases", "Cases", "Failing ones first.", {}};
    for (const char* name : {"verdict", "solver", "kind", "case", "status"}) table.columns.push_back({name, "", text});
    table.columns.push_back({"residual", "", figure, 2});
    table.columns.push_back({"tolerance", "", figure, 2});
    table.columns.push_back({"derivative identity", "", figure, 2});
    table.columns.push_back({"vertices", "", figure, 6});
    table.columns.push_back({"steps", "", figure, 6});
    table.columns.push_back({"time", "s", figure, 3});
    table.columns.push_back({"replay", "", text});
    std::size_t passed = 0;
    for (const StabilityOutcome& one : outcomes)
        if (!one.passed() || ++passed <= most_passed) table.rows.push_back(row_of(one));
    if (passed > most_passed)
        table.note += fmt::format(" {} more that passed are in stability.csv.", passed - most_passed);
    return table;
}

}  // namespace

std::optional<ReportSection> stability_section(const std::string& folder) {
    const std::string path = (std::filesystem::path(folder) / "stability.json").string();
    if (!std::filesystem::exists(path)) return std::nullopt;
    const std::vector<StabilityOutcome> outcomes = read_stability_results(path);
    int failed = 0, claims = 0, absent = 0;
    for (const StabilityOutcome& one : outcomes) {
        failed += !one.passed() && one.available();
        claims += one.false_claim();
        absent += !one.available();
    }
    ReportSection section{"stability", "Stability"};
    section.text.push_back(fmt::format("{} cases: {} passed, {} failed, {} of them by a false claim; {} not available.",
                                       outcomes.size(), outcomes.size() - failed - absent, failed, claims, absent));
    section.text.push_back(std::string("A drape passes with ") + simulator_promise +
                           ". A projected sample passes with " + prior_promise + ".");
    section.text.push_back(
        "A failing case is run again from its replay: toile simulate --replay FILE for a drape, toile project for a "
        "sample; stability.csv has each one's command, from the folder of results.");
    section.blocks.push_back(by_solver(outcomes));
    section.blocks.push_back(by_case(outcomes));
    return section;
}

}  // namespace toile::evaluate
