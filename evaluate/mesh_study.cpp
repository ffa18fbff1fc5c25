#include "evaluate/mesh_study.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "cloth/error.h"
#include "evaluate/noise_source.h"
#include "evaluate/prior_sweep.h"
#include "generate/scene.h"

namespace toile::evaluate {
namespace {

constexpr double mesh_tolerance = 1e-6;
/// Of the predictions: root mean square [m], and the edge length at which their white part is a third of it.
constexpr double error_rms = 0.005, error_edge = 0.0175;

/// A prior on one mesh.
struct SizedPrior {
    std::string name;
    std::unique_ptr<StudiedPrior> prior;
    std::vector<StudiedPrior::Solved> solved;      // [poses]
    std::vector<StudiedPrior::Gradient> gradient;  // [poses]
    std::vector<std::vector<double>> loss;         // [poses] ∂E/∂r*
};

/// The garment at one edge length, with all that is timed on it.
struct SizedGarment {
    double edge_length = 0;
    generate::Scene scene;
    std::unique_ptr<simulate::Draper> draper;
    Positions neutral;
    std::shared_ptr<FactorisationUnit> unit;
    std::vector<std::vector<double>> target, predicted;  // [poses]
    std::vector<std::unique_ptr<SizedPrior>> prior;

    int vertices() const { return scene.garment.mesh.vertex_count(); }
    simulate::DrapeResult drape(const RuntimeSamples& samples, int pose) const {
        return scene.body ? draper->drape(neutral, samples.record[pose].pose) : draper->drape_neutral();
    }
};

std::vector<double> flat(const Positions& position) {
    return {position.data(), position.data() + position.size()};
}

/// Drapes the poses and takes the drapes with noise for predictions.
void drape_and_predict(SizedGarment& garment, const RuntimeSamples& samples, int poses, Study& study) {
    for (int k = 0; k < poses; ++k) {
        const simulate::DrapeResult draped = garment.drape(samples, k);
        if (!draped.position.allFinite()) throw Error("a drape is not finite");
        if (draped.status != simulate::DrapeStatus::accepted)
            study.left_out.push_back(
                fmt::format("edges of {:.3g} m, pose {}: the drape is not accepted ({}); it is "
                            "timed all the same",
                            garment.edge_length, samples.record[k].id, simulate::status_reason(draped.status)));
        const double roughness = garment.edge_length / error_edge;
        garment.target.push_back(flat(draped.position));
        garment.predicted.push_back(flat(noisy_cloth(draped.position, garment.neutral, error_rms, roughness,
                                                     static_cast<std::uint64_t>(samples.record[k].id) + 1)));
    }
}

void add_priors(SizedGarment& garment, int poses) {
    const prior::RestState rest = prior::rest_state(garment.scene.garment.mesh);
    garment.unit = std::make_shared<FactorisationUnit>(rest.edge, garment.neutral);
    for (const SolutionMethod& method : solution_methods()) {
        if (!garment.prior.empty() && garment.prior.back()->name == method.prior) continue;
        auto one = std::make_unique<SizedPrior>();
        one->name = method.prior;
        one->prior = method.make(rest, mesh_tolerance, 1);
        one->solved.resize(poses);
        one->gradient.resize(poses);
        one->loss.resize(poses);
        garment.prior.push_back(std::move(one));
    }
}

std::unique_ptr<SizedGarment> make_garment(const RuntimeSamples& samples, const std::string& dataset,
                                           double edge_length, int poses, Study& study) {
    auto garment = std::make_unique<SizedGarment>();
    garment->edge_length = edge_length;
    generate::SceneConfig config =
        dataset_config(samples.header, dataset, {fmt::format("garment.edge_length={}", edge_length)});
    config.ladder.tries = 0;
    garment->scene = generate::build_scene(config);
    garment->draper = generate::make_draper(garment->scene);
    garment->neutral = garment->draper->drape_neutral().position;
    if (!garment->neutral.allFinite()) throw Error("the garment cannot be draped in the neutral pose");
    drape_and_predict(*garment, samples, poses, study);
    add_priors(*garment, poses);
    return garment;
}

/// What is timed on each size, in this order.
std::vector<TimedTask> tasks_of(const SizedGarment& garment, const RuntimeSamples& samples) {
    std::vector<TimedTask> task;
    for (const auto& one : garment.prior) {
        SizedPrior* const prior = one.get();
        const SizedGarment* const all = &garment;
        task.push_back({prior->name + ", projection",
                        [prior, all](int s) { prior->prior->project(all->predicted[s], prior->solved[s]); }});
        task.push_back({prior->name + ", backward pass",
                        [prior, all](int s) {
                            prior->prior->backward(all->predicted[s], prior->solved[s], prior->loss[s],
                                                   prior->gradient[s]);
                        },
                        [prior, all](int s) {
                            prior->loss[s] = prior->solved[s].position;
                            for (size_t k = 0; k < prior->loss[s].size(); ++k)
                                prior->loss[s][k] = 2.0 * (prior->loss[s][k] - all->target[s][k]);
                        }});
    }
    task.push_back({"one factorisation", [unit = factorisation(garment.unit)](int) { unit(); }});
    task.push_back({"drape", [&garment, &samples](int s) { garment.drape(samples, s); }});
    return task;
}

void tell_unsolved(const SizedGarment& garment, Study& study) {
    for (const auto& one : garment.prior)
        for (const StudiedPrior::Solved& solved : one->solved)
            if (solved.report[0].status != prior::Status::converged) {
                ++study.refused;
                study.left_out.push_back(
                    fmt::format("{} vertices, {}: a projection did not reach {:.0e} (residual "
                                "{:.1e})",
                                garment.vertices(), one->name, mesh_tolerance, solved.report[0].residual));
            }
}

void fit_exponents(Study& study, int samples) {
    StudyTable fits{"mesh-exponents",
                    "Cost exponents",
                    "Seconds grow as the number of vertices to this power; least squares in logarithms, with twice "
                    "the standard error.",
                    {{"what", ""}, {"exponent", ""}},
                    {}};
    for (const StudySeries& series : study.curves[0].series) {
        std::vector<double> x, y;
        for (const StudyPoint& point : series.point) {
            x.push_back(point.x.middle);
            y.push_back(point.y.middle);
        }
        const PowerLaw law = fit_power_law(x, y);
        const Spread exponent{law.exponent_low, law.exponent, law.exponent_high};
        std::string name = series.name;
        std::replace(name.begin(), name.end(), ' ', '_');
        name.erase(std::remove(name.begin(), name.end(), ','), name.end());
        add_metric(study, name + "/exponent", exponent, "exponent", samples);
        fits.row.push_back({series.name, exponent});
    }
    study.table.insert(study.table.begin(), fits);
}

void gather(Study& study, const std::vector<std::unique_ptr<SizedGarment>>& garments,
            const std::vector<TimedTask>& task, const Timings& timings, int poses) {
    study.curves.push_back({"mesh-cost",
                            "Cost by size of the mesh",
                            "Median and quartiles over the poses; tolerance 1e-6, one thread.",
                            {"vertices", "", true},
                            {"seconds a sample", "s", true},
                            {}});
    study.table.push_back(
        {"mesh-table", "Size of the mesh", "", {{"what", ""}, {"edges", "mm"}, {"vertices", ""}, {"time", "ms"}}, {}});
    const size_t kinds = task.size() / garments.size();
    for (size_t kind = 0; kind < kinds; ++kind) {
        StudySeries& series = study.curves[0].series.emplace_back();
        series.name = task[kind].name;
        for (size_t g = 0; g < garments.size(); ++g) {
            const Spread seconds = timings.seconds(static_cast<int>(g * kinds + kind));
            const double vertices = garments[g]->vertices();
            const double edge = 1e3 * garments[g]->edge_length;
            series.point.push_back({fmt::format("edges of {:.3g} mm", edge), {vertices, vertices, vertices}, seconds});
            study.table[0].row.push_back(
                {series.name, edge, vertices, Spread{1e3 * seconds.low, 1e3 * seconds.middle, 1e3 * seconds.high}});
        }
    }
    fit_exponents(study, poses);
}

}  // namespace

std::string why_no_sizes(const RuntimeSamples& samples, const std::string& dataset) {
    try {
        const generate::SceneConfig config = dataset_config(samples.header, dataset, {});
        if (config.garment.source == generate::GarmentSource::file)
            return "the garment comes from a file, which can be refined but not made anew at another size";
    } catch (const Error& error) {
        return std::string("the data set's scene cannot be built again: ") + error.what();
    }
    return {};
}

Study study_meshes(const RuntimeSamples& samples, const std::string& dataset, const MeshSweep& sweep,
                   const RepeatOptions& repeat, const Clock& clock) {
    Study study;
    study.name = "mesh";
    study.title = "Size of the mesh: cost";
    if (const std::string why = why_no_sizes(samples, dataset); !why.empty()) {
        study.left_out.push_back(why);
        return study;
    }
    const int poses = samples.header.body ? std::min(sweep.poses, samples.count()) : 1;
    std::vector<std::unique_ptr<SizedGarment>> garments;
    for (const double edge_length : sweep.edge_length) {
        try {
            garments.push_back(make_garment(samples, dataset, edge_length, poses, study));
        } catch (const Error& error) {
            study.left_out.push_back(fmt::format("edges of {:.3g} m: {}", edge_length, error.what()));
        }
    }
    if (garments.empty()) return study;
    std::vector<TimedTask> task;
    for (const auto& one : garments)
        for (TimedTask& each : tasks_of(*one, samples)) task.push_back(std::move(each));
    const Timings timings = time_interleaved(task, poses, factorisation(unit_of(samples)), repeat, clock);
    study.text.push_back(fmt::format(
        "The data set's garment made anew at {} edge lengths and draped in {} of its poses. Predictions: each drape "
        "with an error of {:.0f} mm, the same smooth one at every size and white noise in proportion to the edges.",
        garments.size(), poses, 1e3 * error_rms));
    for (const auto& one : garments) tell_unsolved(*one, study);
    gather(study, garments, task, timings, poses);
    return study;
}

}  // namespace toile::evaluate
