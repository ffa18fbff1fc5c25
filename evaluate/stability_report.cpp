#include "evaluate/stability_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluate/stability_picture.h"
#include "files/image_file.h"
#include "files/new_file.h"
#include "generate/output_folder.h"

namespace toile::evaluate {
namespace {

std::string energy_text(const StabilityOutcome& one) {
    if (!one.energy.measured()) return "not measured";
    return one.falling ? "falls" : fmt::format("rose {:.0e} m", one.energy.largest_rise());
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

nlohmann::ordered_json number(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json as_json(const StabilityOutcome& one) {
    const simulate::Certificate& c = one.certificate;
    return {{"group", one.group},
            {"case", one.name},
            {"solver", one.solver},
            {"passed", one.passed()},
            {"status", one.status},
            {"at_rest_within_gate", one.rests},
            {"finite", one.finite},
            {"energy_measured", one.energy.measured()},
            {"energy_never_rises", one.falling},
            {"energy_largest_rise", number(one.energy.largest_rise())},
            {"residual_force", number(c.residual_force)},
            {"max_speed", number(c.max_speed)},
            {"body_penetration", number(c.body_penetration)},
            {"self_intersections", c.self_intersections},
            {"min_stretch", number(c.min_stretch)},
            {"max_stretch", number(c.max_stretch)},
            {"vertices", one.vertices},
            {"iterations", one.iterations},
            {"seconds", number(c.seconds)}};
}

/// One field of comma-separated values: text in quotes, quotes in it doubled.
std::string field(const nlohmann::ordered_json& value) {
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    std::string text = "\"";
    for (const char c : value.get<std::string>()) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
}

/// The fields of the JSON as rows of comma-separated values.
std::string as_csv(const nlohmann::ordered_json& list) {
    std::string text;
    for (const auto& [key, value] : list.at(0).items()) text += (text.empty() ? "" : ",") + key;
    for (const nlohmann::ordered_json& row : list) {
        std::string line;
        for (const auto& value : row) line += (line.empty() ? "" : ",") + field(value);
        text += "\n" + line;
    }
    return text + "\n";
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
    summary.outcome = run_stability(options);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const StabilityOutcome& one : summary.outcome) list.push_back(as_json(one));
    const nlohmann::ordered_json document{
        {"format", "toile"}, {"kind", "stability"}, {"program_version", TOILE_VERSION}, {"cases", list}};
    files::write_text_file(summary.path[0], as_csv(list));
    files::write_text_file(summary.path[1], document.dump(2) + "\n");
    files::write_png(summary.path[2], stability_picture(summary.outcome, solvers_of(summary.outcome)));
    return summary;
}

}  // namespace toile::evaluate
