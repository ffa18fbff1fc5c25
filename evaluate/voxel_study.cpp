#include "evaluate/voxel_study.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <memory>
#include <optional>

#include "cloth/error.h"
#include "evaluate/noise_source.h"
#include "evaluate/prior_sweep.h"
#include "generate/scene.h"
#include "generate/stored_body.h"
#include "simulate/collision_body.h"
#include "skin/surface_query.h"

namespace toile::evaluate {
namespace {

/// A point near the body, and how far it really is from it.
struct Probe {
    Eigen::Vector3d point;
    double distance;  // [m], negative inside
};

struct PosedSample {
    Positions body, cloth;
    std::vector<Probe> probe;
};

struct PosedScene {
    skin::Body body;
    double thickness = simulate::ContactOptions().thickness;
    std::vector<PosedSample> sample;
};

std::vector<Probe> make_probes(const skin::Body& body, const Positions& posed, const Positions& cloth) {
    const skin::SurfaceQuery query(body.triangle, posed);
    std::vector<Probe> probe;
    for (Eigen::Index v = 0; v < cloth.rows(); ++v) {
        const Eigen::Vector3d vertex = cloth.row(v).transpose();
        const skin::SurfaceQuery::Nearest below = query.nearest(vertex);
        if (below.distance < 1e-6) continue;
        const Eigen::Vector3d outwards =
            (vertex - below.position).normalized() * (below.signed_distance < 0.0 ? -1.0 : 1.0);
        for (const double offset : {-0.002, -0.001, 0.001, 0.002, 0.005}) {
            const Eigen::Vector3d point = below.position + offset * outwards;
            const double distance = query.nearest(point).signed_distance;
            // A sign that disagrees is where parts of the body overlap: the surface there is inside the body.
            if ((distance < 0.0) == (offset < 0.0)) probe.push_back({point, distance});
        }
    }
    return probe;
}

/// The body that the samples were draped on; the configuration's knows its parts, the stored one is a fallback.
PosedScene make_scene(const RuntimeSamples& samples, const std::string& dataset) {
    const skin::Body stored = generate::skinned_body(*samples.header.body);
    PosedScene scene;
    scene.body = stored;
    try {
        const generate::SceneConfig config = dataset_config(samples.header, dataset, {});
        if (config.contact) scene.thickness = config.contact->thickness;
        const std::optional<skin::Body> body = generate::build_posed_body(config).body;
        if (body && body->triangle == stored.triangle) scene.body = *body;
    } catch (const Error&) {
        // What the configuration names is not here: the stored body does.
    }
    for (const files::SampleRecord& record : samples.record) {
        PosedSample& one = scene.sample.emplace_back();
        one.body = generate::posed_as_stored(samples.header, stored, record).position;
        one.cloth = record.cloth;
        one.probe = make_probes(scene.body, one.body, one.cloth);
    }
    return scene;
}

simulate::BodyLevelSet build(const PosedScene& scene, int sample, double voxel) {
    const PosedSample& one = scene.sample[sample];
    return simulate::BodyLevelSet(scene.body, one.body, one.cloth, voxel, scene.thickness);
}

/// Errors over all probes of each sample [m].
struct VoxelError {
    std::vector<double> rms, largest, penetration;
};

VoxelError errors_of(const PosedScene& scene, double voxel) {
    VoxelError error;
    for (int s = 0; s < static_cast<int>(scene.sample.size()); ++s) {
        const simulate::BodyLevelSet built = build(scene, s, voxel);
        const skin::LevelSet::Sampler sampler(built.level_set);
        double sum = 0.0, largest = 0.0, deepest = 0.0;
        for (const Probe& probe : scene.sample[s].probe) {
            const double off = std::abs(sampler.distance(probe.point) - probe.distance);
            sum += off * off;
            largest = std::max(largest, off);
            if (probe.distance < 0.0) deepest = std::max(deepest, off);
        }
        error.rms.push_back(1e3 * std::sqrt(sum / static_cast<double>(scene.sample[s].probe.size())));
        error.largest.push_back(1e3 * largest);
        error.penetration.push_back(1e3 * deepest);
    }
    return error;
}

void prepare_results(Study& study) {
    study.curves.push_back({"voxel-error",
                            "Error of the level set against the time to build it",
                            "At points 2 mm inside to 5 mm outside of the body, below each cloth vertex. Bars: "
                            "quartiles over the samples.",
                            {"seconds to build it", "s", true},
                            {"error of the signed distance", "mm", true},
                            {{"root mean square", {}}, {"largest", {}}, {"largest of the depth inside", {}}}});
    study.table.push_back({"voxel-table",
                           "Level set: voxel size",
                           "",
                           {{"voxel", "mm"},
                            {"time to build", "ms"},
                            {"factorisations", "ratio"},
                            {"error, rms", "mm"},
                            {"largest", "mm"},
                            {"largest of the depth", "mm"}},
                           {}});
}

void add_result(Study& study, double voxel, const VoxelError& error, const Timings& timings, int task, int samples) {
    const std::string name = fmt::format("{:.2g}mm", 1e3 * voxel), label = fmt::format("voxel {:.2g} mm", 1e3 * voxel);
    const Spread seconds = timings.seconds(task), rms = quartiles(error.rms), largest = quartiles(error.largest),
                 depth = quartiles(error.penetration);
    add_time_metrics(study, name, timings, task, samples);
    add_metric(study, name + "/rms", rms, "mm", samples, 0.2);
    add_metric(study, name + "/largest", largest, "mm", samples);
    add_metric(study, name + "/depth", depth, "mm", samples);
    study.curves[0].series[0].point.push_back({label, seconds, rms});
    study.curves[0].series[1].point.push_back({label, seconds, largest});
    study.curves[0].series[2].point.push_back({label, seconds, depth});
    study.table[0].row.push_back({1e3 * voxel, Spread{1e3 * seconds.low, 1e3 * seconds.middle, 1e3 * seconds.high},
                                  timings.units(task), rms, largest, depth});
}

}  // namespace

Study study_voxels(const RuntimeSamples& samples, const std::string& dataset, const VoxelSweep& sweep,
                   const RepeatOptions& repeat, const Clock& clock) {
    Study study;
    study.name = "voxel";
    study.title = "Level set: voxel size";
    if (!samples.header.body || !samples.header.embedding) {
        study.left_out.push_back("the data set has no body: there is no level set to build");
        return study;
    }
    const PosedScene scene = make_scene(samples, dataset);
    std::vector<TimedTask> task;
    for (const double voxel : sweep.voxel)
        task.push_back({"voxel", [&scene, voxel](int s) { build(scene, s, voxel); }});
    const auto unit = unit_of(samples);
    const Timings timings = time_interleaved(task, samples.count(), factorisation(unit), repeat, clock);
    study.text.push_back(timing_note(samples, timings, *unit));
    prepare_results(study);
    std::vector<double> edge, seconds;
    for (size_t k = 0; k < sweep.voxel.size(); ++k) {
        add_result(study, sweep.voxel[k], errors_of(scene, sweep.voxel[k]), timings, static_cast<int>(k),
                   samples.count());
        edge.push_back(1.0 / sweep.voxel[k]);
        seconds.push_back(timings.seconds(static_cast<int>(k)).middle);
    }
    const PowerLaw cost = fit_power_law(edge, seconds);
    add_metric(study, "exponent", {cost.exponent_low, cost.exponent, cost.exponent_high}, "exponent", samples.count());
    study.text.push_back(
        fmt::format("The time to build grows as one over the voxel to the power {}.", short_number(cost.exponent)));
    return study;
}

}  // namespace toile::evaluate
