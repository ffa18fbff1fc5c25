#include "evaluate/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cloth/error.h"
#include "evaluate/case_meshes.h"
#include "generate/ordered_work.h"

namespace toile::evaluate {

void EnergyTrace::add(const simulate::EnergySample& sample) {
    constexpr double rounding = 1e-6;  // [m]
    if (std::isnan(sample.energy)) return;
    measured_ = true;
    if (!sample.first) {
        ++steps_;
        const double rise = (sample.energy - last_ - held_) / weight_;
        rise_ = std::max(rise_, rise);
        if (rise > rounding) ++rises_;
    }
    last_ = sample.energy;
    held_ = sample.held_by_friction;
}

double EnergyTrace::largest_rise() const {
    return measured_ ? rise_ : std::numeric_limits<double>::quiet_NaN();
}

const std::vector<std::string>& solver_names() {
    static const std::vector<std::string> names{"implicit", "xpbd", "bullet"};
    return names;
}

std::string missing_solver(const std::string& solver) {
    simulate::DrapeScene scene;
    scene.mesh = grid_cloth(even_lines(1, 0.1), even_lines(1, 0.1), 0.0, 0.2);
    scene.pinned = {0, 1, 2, 3};
    scene.solver.solver = solver;
    try {
        simulate::Draper(scene).drape_neutral();
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

namespace {

void drape_case(const StabilityScene& scene, StabilityOutcome& outcome) {
    EnergyTrace trace(9.81 * scene.drape.mesh.mass.sum());
    const simulate::EnergyWatch watch = [&](const simulate::EnergySample& sample) { trace.add(sample); };
    const simulate::Draper draper(scene.drape);
    simulate::DrapeResult result = draper.drape_neutral(watch);
    double seconds = result.certificate.seconds;
    outcome.iterations = result.report.iterations;
    outcome.rests = result.status == simulate::DrapeStatus::accepted;
    outcome.status = simulate::status_reason(result.status);
    if (scene.pose && result.position.allFinite()) {
        if (!outcome.rests) outcome.status = "neutral pose: " + outcome.status;
        result = draper.drape(result.position, *scene.pose, watch);
        seconds += result.certificate.seconds;
        outcome.iterations += result.report.iterations;
        if (outcome.rests) outcome.status = simulate::status_reason(result.status);
        outcome.rests = outcome.rests && result.status == simulate::DrapeStatus::accepted;
    }
    outcome.finite = result.position.allFinite();
    outcome.certificate = result.certificate;
    outcome.certificate.seconds = seconds;
    outcome.energy_rise = trace.largest_rise();
    outcome.falling = trace.rises() == 0;
}

std::vector<StabilityCase> chosen_cases(const StabilityOptions& options) {
    std::vector<StabilityCase> chosen;
    for (StabilityCase& one : stability_cases())
        if ((!options.quick || one.quick) && one.name.find(options.filter) != std::string::npos)
            chosen.push_back(std::move(one));
    if (chosen.empty())
        throw Error("no case of the suite has \"" + options.filter + "\" in its name", "--filter",
                    "without --filter the table lists all names");
    return chosen;
}

StabilityOutcome absent(const StabilityCase& one, const std::string& solver, const std::string& why) {
    StabilityOutcome outcome;
    outcome.group = one.group;
    outcome.name = one.name;
    outcome.solver = solver;
    outcome.status = "not available: " + why;
    return outcome;
}

/// By solver, then in the suite's order.
void sort_outcomes(std::vector<StabilityOutcome>& outcomes) {
    const std::vector<StabilityCase> all = stability_cases();
    const auto place = [&](const StabilityOutcome& one) {
        const auto& names = solver_names();
        const auto solver = std::find(names.begin(), names.end(), one.solver) - names.begin();
        const auto at = std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == one.name; });
        return std::pair(solver, at - all.begin());
    };
    std::stable_sort(outcomes.begin(), outcomes.end(),
                     [&](const auto& one, const auto& other) { return place(one) < place(other); });
}

}  // namespace

StabilityOutcome run_stability_case(const StabilityCase& one, const std::string& solver,
                                    const StabilityBudget& budget) {
    StabilityOutcome outcome;
    outcome.group = one.group;
    outcome.name = one.name;
    outcome.solver = solver;
    try {
        StabilityScene scene = one.build();
        scene.drape.solver.solver = solver;
        if (budget.iterations) scene.drape.solver.max_iterations = *budget.iterations;
        if (budget.tries) scene.drape.ladder.tries = *budget.tries;
        outcome.vertices = scene.drape.mesh.vertex_count();
        drape_case(scene, outcome);
    } catch (const std::exception& failure) {
        outcome.rests = outcome.finite = false;
        outcome.status = std::string("refused: ") + failure.what();
    }
    return outcome;
}

std::vector<StabilityOutcome> run_stability(const StabilityOptions& options) {
    const std::vector<StabilityCase> cases = chosen_cases(options);
    std::vector<StabilityOutcome> outcomes = options.known;
    const auto is_known = [&](const std::string& solver, const StabilityCase& one) {
        return std::any_of(options.known.begin(), options.known.end(), [&](const StabilityOutcome& known) {
            return known.solver == solver && known.name == one.name;
        });
    };
    const int total = static_cast<int>(cases.size() * options.solver.size());
    int failed = 0, done = 0;
    for (const std::string& solver : options.solver) {
        const std::string missing = missing_solver(solver);
        for (const StabilityCase& one : cases) {
            if (options.progress) options.progress({solver, done++, total, failed});
            if (is_known(solver, one)) continue;
            if (options.interrupted && *options.interrupted)
                throw generate::Interrupted("interrupted: --resume goes on from what is done");
            outcomes.push_back(missing.empty() ? run_stability_case(one, solver, options.budget)
                                               : absent(one, solver, missing));
            if (!outcomes.back().passed()) ++failed;
            if (options.store) options.store(outcomes);
        }
    }
    sort_outcomes(outcomes);
    return outcomes;
}

}  // namespace toile::evaluate
