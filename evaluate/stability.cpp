#include "evaluate/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "evaluate/case_meshes.h"
#include "evaluate/stability_priors.h"
#include "evaluate/stability_replay.h"
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

StabilityScene case_scene(const StabilityCase& one, const std::string& solver, const StabilityBudget& budget) {
    StabilityScene scene = one.build();
    scene.drape.solver.solver = solver;
    if (budget.iterations) scene.drape.solver.max_iterations = *budget.iterations;
    if (budget.tries) scene.drape.ladder.tries = *budget.tries;
    return scene;
}

simulate::DrapeResult drape_case(const StabilityScene& scene, StabilityOutcome& outcome) {
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
    return result;
}

namespace {

std::vector<StabilityCase> chosen_cases(const StabilityOptions& options) {
    std::vector<StabilityCase> chosen;
    for (StabilityCase& one : stability_cases())
        if ((!options.quick || one.quick) && one.name.find(options.filter) != std::string::npos)
            chosen.push_back(std::move(one));
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

/// By solver, then in the suite's order, samples by their problem.
void sort_outcomes(std::vector<StabilityOutcome>& outcomes) {
    std::map<std::string, int> solver_place, case_place;
    for (const std::string& solver : solver_names()) solver_place.emplace(solver, solver_place.size());
    for (const std::string& prior : prior_names())
        for (const StressRoute route : {StressRoute::own, StressRoute::paper})
            solver_place.emplace(prior_solver(prior, route), solver_place.size());
    for (const StabilityCase& one : stability_cases()) case_place.emplace(one.name, case_place.size());
    const auto place = [](const std::map<std::string, int>& all, const std::string& name) {
        const auto found = all.find(name);
        return found == all.end() ? static_cast<int>(all.size()) : found->second;
    };
    const auto key = [&](const StabilityOutcome& one) {
        return one.prior ? std::tuple(place(solver_place, one.solver), one.prior->problem, one.prior->sample)
                         : std::tuple(place(solver_place, one.solver), place(case_place, one.name), 0);
    };
    std::stable_sort(outcomes.begin(), outcomes.end(),
                     [&](const auto& one, const auto& other) { return key(one) < key(other); });
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// One run: what is known, what comes, and who is told.
class Run {
  public:
    explicit Run(const StabilityOptions& options) : options_(options), outcomes_(options.known) {
        for (const StabilityOutcome& one : options.known) known_.emplace(one.solver, one.name);
    }

    void drape_cases(const std::string& solver, const std::vector<StabilityCase>& cases) {
        const std::string missing = missing_solver(solver);
        int done = 0, failed = 0;
        for (const StabilityCase& one : cases) {
            tell(solver, done++, static_cast<int>(cases.size()), failed);
            if (known_.count({solver, one.name})) continue;
            check_interrupt();
            outcomes_.push_back(missing.empty() ? run_stability_case(one, solver, options_.budget, options_.folder)
                                                : absent(one, solver, missing));
            if (!outcomes_.back().passed()) ++failed;
            store();
        }
    }

    /// Problems side by side, so many at a time that results are stored a few dozen times.
    void project_problems(PriorKind prior, StressRoute route, const std::vector<int>& problems) {
        const std::string solver = prior_solver(std::string(name(prior)), route);
        const int total = static_cast<int>(problems.size()), chunk = std::max(8 * options_.jobs, total / 32);
        int failed = 0;
        for (int first = 0; first < total; first += chunk) {
            tell(solver, first, total, failed);
            check_interrupt();
            std::vector<std::vector<StabilityOutcome>> found(std::min(chunk, total - first));
            parallel_for(static_cast<int>(found.size()), options_.jobs, [&](int, int k) {
                found[k] =
                    run_prior_problem(options_.priors, problems[first + k], route, wanted(solver), options_.folder);
            });
            for (auto& part : found)
                for (StabilityOutcome& one : part) {
                    if (!one.passed()) ++failed;
                    outcomes_.push_back(std::move(one));
                }
            store();
        }
    }

    std::vector<StabilityOutcome> result() {
        sort_outcomes(outcomes_);
        return std::move(outcomes_);
    }

  private:
    std::function<bool(const std::string&)> wanted(const std::string& solver) const {
        return [this, solver](const std::string& name) {
            return name.find(options_.filter) != std::string::npos && !known_.count({solver, name});
        };
    }
    void tell(const std::string& solver, int done, int total, int failed) const {
        if (options_.progress) options_.progress({solver, done, total, failed});
    }
    void check_interrupt() const {
        if (options_.interrupted && *options_.interrupted)
            throw generate::Interrupted("interrupted: --resume goes on from what is done");
    }
    void store() const {
        if (options_.store) options_.store(outcomes_);
    }

    const StabilityOptions& options_;
    std::vector<StabilityOutcome> outcomes_;
    std::set<std::pair<std::string, std::string>> known_;
};

}  // namespace

StabilityOutcome run_stability_case(const StabilityCase& one, const std::string& solver, const StabilityBudget& budget,
                                    const std::string& folder) {
    StabilityOutcome outcome;
    outcome.group = one.group;
    outcome.name = one.name;
    outcome.solver = solver;
    std::optional<StabilityScene> scene;
    std::optional<simulate::DrapeResult> drape;
    try {
        scene = case_scene(one, solver, budget);
        outcome.vertices = scene->drape.mesh.vertex_count();
        drape = drape_case(*scene, outcome);
    } catch (const std::exception& failure) {
        outcome.rests = outcome.finite = false;
        outcome.status = std::string("refused: ") + failure.what();
    }
    if (!folder.empty() && !outcome.passed())
        keep_case(folder, scene ? &*scene : nullptr, drape ? &*drape : nullptr, budget, outcome);
    return outcome;
}

std::vector<StabilityOutcome> run_stability(const StabilityOptions& options) {
    const std::vector<StabilityCase> cases = chosen_cases(options);
    Run run(options);
    bool any = false;
    for (const std::string& solver : options.solver) {
        if (!has(prior_names(), solver)) {
            any = any || !cases.empty();
            run.drape_cases(solver, cases);
            continue;
        }
        const PriorKind prior =
            solver == name(PriorKind::quasistatic) ? PriorKind::quasistatic : PriorKind::inextensibility;
        for (const StressRoute route : {StressRoute::own, StressRoute::paper}) {
            const std::vector<int> problems =
                chosen_problems(options.priors, prior, route, options.quick, options.filter);
            any = any || !problems.empty();
            run.project_problems(prior, route, problems);
        }
    }
    if (!any)
        throw Error("no case of the suite has \"" + options.filter + "\" in its name", "--filter",
                    "without --filter the table lists all names");
    return run.result();
}

}  // namespace toile::evaluate
