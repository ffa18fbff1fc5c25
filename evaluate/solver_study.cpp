#include "evaluate/solver_study.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "evaluate/noise_source.h"
#include "evaluate/prior_sweep.h"
#include "evaluate/solver_settings.h"
#include "evaluate/studied_prior.h"
#include "generate/scene.h"

namespace toile::evaluate {
namespace {

using simulate::DrapeResult;
using simulate::DrapeStatus;

/// The data set's scene, and where each pose ought to come to rest.
struct DrapedScene {
    generate::Scene scene;
    Positions neutral;
    std::vector<std::optional<skin::Pose>> pose;  // none in a scene without a body
    std::vector<Positions> reference;
};

DrapeResult drape(const simulate::Draper& draper, const DrapedScene& drapes, const std::optional<skin::Pose>& pose) {
    return pose ? draper.drape(drapes.neutral, *pose) : draper.drape_neutral();
}

DrapedScene make_scene(const RuntimeSamples& samples, const std::string& dataset, const SolverSweep& sweep) {
    generate::SceneConfig config = dataset_config(samples.header, dataset, sweep.changes);
    config.ladder.tries = 0;  // or what does not come to rest would be timed several times
    DrapedScene drapes;
    drapes.scene = generate::build_scene(config);
    const bool same = drapes.scene.garment.mesh.triangle == samples.header.mesh.triangle;
    if (!same && sweep.changes.empty())
        throw Error("the garment of this data set's configuration is no longer the one it holds", dataset);
    drapes.neutral =
        same ? samples.header.mesh.rest_position : generate::make_draper(drapes.scene)->drape_neutral().position;
    if (!drapes.neutral.allFinite()) throw Error("the garment cannot be draped in the neutral pose", dataset);
    return drapes;
}

std::unique_ptr<simulate::Draper> draper_of(DrapedScene& drapes, const SolverSetting& setting) {
    const generate::SceneConfig config = drapes.scene.config;
    setting.apply(drapes.scene.config.solver, drapes.scene.config.path);
    std::unique_ptr<simulate::Draper> draper = generate::make_draper(drapes.scene);
    drapes.scene.config = config;
    return draper;
}

/// Drapes the poses with the tightest setting; those whose reference the gate refuses are told and left out.
void make_references(DrapedScene& drapes, const RuntimeSamples& samples, const SolverSweep& sweep, Study& study) {
    const std::unique_ptr<simulate::Draper> tightest =
        draper_of(drapes, {"", "implicit", "", [](auto& solver, auto& path) { make_tightest(solver, path); }});
    const int wanted = std::min(sweep.poses, samples.count());
    double worst = 0.0;
    for (int s = 0; s < wanted; ++s) {
        std::optional<skin::Pose> pose;
        if (drapes.scene.body) pose = samples.record[s].pose;
        DrapeResult result = drape(*tightest, drapes, pose);
        if (result.status != DrapeStatus::accepted) {
            ++study.refused;
            study.left_out.push_back(fmt::format("pose {}: the tightest reference is not accepted ({}); it is refused",
                                                 samples.record[s].id, simulate::status_reason(result.status)));
            continue;
        }
        worst = std::max(worst, result.certificate.residual_force);
        drapes.pose.push_back(std::move(pose));
        drapes.reference.push_back(std::move(result.position));
        if (!drapes.scene.body) break;  // every sample is the same drape
    }
    study.text.push_back(fmt::format(
        "{} poses of the data set's own scene at {} vertices. Reference: implicit with a quarter of the steps and a "
        "tolerance of 1e-7, accepted by the gate; largest residual force {:.1e} of the garment's weight. Every drape "
        "sets out from the same neutral drape and has one try. Cloth with friction rests where its path has left it: a "
        "distance that no setting lowers is that of two paths, not of a solver.",
        drapes.pose.size(), drapes.scene.garment.mesh.vertex_count(), worst));
}

/// A setting and what it made of each pose.
struct SweptSolver {
    SolverSetting setting;
    std::unique_ptr<simulate::Draper> draper;
    std::vector<DrapeResult> result;  // [poses] of the last round
    bool given_up = false;
};

std::vector<std::unique_ptr<SweptSolver>> make_solvers(DrapedScene& drapes, const SolverSweep& sweep, Study& study) {
    std::vector<std::unique_ptr<SweptSolver>> solvers;
    for (const SolverSetting& setting : solver_settings(sweep.quick ? SettingChoice::quick : SettingChoice::all)) {
        auto one = std::make_unique<SweptSolver>();
        one->setting = setting;
        try {
            one->draper = draper_of(drapes, setting);
        } catch (const Error& error) {
            study.left_out.push_back(fmt::format("{}, {}: {}", setting.series, setting.name, error.what()));
            continue;
        }
        one->result.resize(drapes.pose.size());
        solvers.push_back(std::move(one));
    }
    return solvers;
}

/// A drape with a setting; or nothing, where the one before it in its series took too long.
void run(SweptSolver& solver, const DrapedScene& drapes, int pose, double patience, const Clock& clock,
         std::map<std::string, const SweptSolver*>& too_slow) {
    const auto slow = too_slow.find(solver.setting.series);
    if (solver.given_up || (slow != too_slow.end() && slow->second != &solver)) {
        solver.given_up = true;
        return;
    }
    const double start = clock();
    solver.result[pose] = drape(*solver.draper, drapes, drapes.pose[pose]);
    if (clock() - start > patience) too_slow.emplace(solver.setting.series, &solver);
}

void prepare_results(Study& study) {
    study.curves.push_back({"solvers-error",
                            "Distance to the tightest drape",
                            "Root mean square over the vertices; median and quartiles over the poses.",
                            {"seconds a drape", "s", true},
                            {"distance to the reference", "mm", true},
                            {}});
    study.table.push_back({"solvers-table",
                           "Simulators: error against run time",
                           "Accepted: drapes that the scene's gate accepts.",
                           {{"solver", ""},
                            {"setting", ""},
                            {"time", "s"},
                            {"factorisations", "ratio"},
                            {"distance, rms", "mm"},
                            {"largest", "mm"},
                            {"steps to rest", ""},
                            {"accepted", "%"},
                            {"refused for", ""}},
                           {}});
}

void add_result(Study& study, const SweptSolver& solver, const DrapedScene& drapes, const Timings& timings, int task) {
    std::vector<double> rms, largest, steps;
    int accepted = 0;
    std::string reason;
    for (size_t s = 0; s < drapes.pose.size(); ++s) {
        const DrapeResult& result = solver.result[s];
        steps.push_back(result.report.iterations);
        if (result.status == DrapeStatus::accepted)
            ++accepted;
        else if (reason.empty())
            reason = simulate::status_reason(result.status);
        if (!result.position.allFinite()) continue;
        const auto numbers = [](const Positions& p) { return std::span(p.data(), static_cast<size_t>(p.size())); };
        const ClothDistance distance = cloth_distance(numbers(result.position), numbers(drapes.reference[s]));
        rms.push_back(1e3 * distance.rms);
        largest.push_back(1e3 * distance.largest);
    }
    const int count = static_cast<int>(drapes.pose.size());
    const std::string name =
        solver.setting.series.substr(0, solver.setting.series.find(',')) + "/" + solver.setting.name;
    const double share = 100.0 * accepted / count;
    add_time_metrics(study, name, timings, task, count);
    add_metric(study, name + "/rms", quartiles(rms), "mm", count);
    add_metric(study, name + "/accepted", {share, share, share}, "%", count);
    const Spread seconds = timings.seconds(task);
    std::vector<StudySeries>& series = study.curves[0].series;
    if (series.empty() || series.back().name != solver.setting.series) series.push_back({solver.setting.series, {}});
    series.back().point.push_back({solver.setting.name, seconds, quartiles(rms)});
    study.table[0].row.push_back({solver.setting.series, solver.setting.name, seconds, timings.units(task),
                                  quartiles(rms), quartiles(largest), quartiles(steps), share, reason});
}

void measure(Study& study, DrapedScene& drapes, const SolverSweep& sweep, const RepeatOptions& repeat,
             const Clock& clock) {
    const auto solvers = make_solvers(drapes, sweep, study);
    std::map<std::string, const SweptSolver*> too_slow;
    std::vector<TimedTask> task;
    for (const auto& one : solvers)
        task.push_back({one->setting.name, [&, solver = one.get()](int pose) {
                            run(*solver, drapes, pose, sweep.patience, clock, too_slow);
                        }});
    const ClothMesh& mesh = drapes.scene.garment.mesh;
    const auto unit = std::make_shared<FactorisationUnit>(build_topology(mesh.triangle).edge, mesh.rest_position);
    const Timings timings =
        time_interleaved(task, static_cast<int>(drapes.pose.size()), factorisation(unit), repeat, clock);
    prepare_results(study);
    for (size_t k = 0; k < solvers.size(); ++k) {
        if (solvers[k]->given_up)
            study.left_out.push_back(
                fmt::format("{}, {}: the setting before it took longer than {:g} s a "
                            "drape",
                            solvers[k]->setting.series, solvers[k]->setting.name, sweep.patience));
        else
            add_result(study, *solvers[k], drapes, timings, static_cast<int>(k));
    }
}

}  // namespace

Study study_solvers(const RuntimeSamples& samples, const std::string& dataset, const SolverSweep& sweep,
                    const RepeatOptions& repeat, const Clock& clock) {
    Study study;
    study.name = "solvers";
    study.title = "Simulators: error against run time";
    DrapedScene drapes;
    try {
        drapes = make_scene(samples, dataset, sweep);
    } catch (const Error& error) {
        study.left_out.push_back(std::string("the data set's scene cannot be built again: ") + error.what());
        return study;
    }
    make_references(drapes, samples, sweep, study);
    if (drapes.pose.empty())
        study.left_out.push_back("no pose has a reference to compare with");
    else
        measure(study, drapes, sweep, repeat, clock);
    return study;
}

}  // namespace toile::evaluate
