#include "evaluate/noise.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "evaluate/noise_results.h"
#include "evaluate/noise_source.h"
#include "files/noise_file.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"
#include "generate/scene.h"

namespace toile::evaluate {
namespace {

using simulate::DrapeResult;
using simulate::DrapeStatus;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// One way of draping, ready for poses.
struct Way {
    std::unique_ptr<simulate::Draper> draper;
    DrapeResult neutral;

    DrapeResult drape(const NoiseSource::Pose& pose) const {
        return pose.pose ? draper->drape(neutral.position, *pose.pose) : neutral;
    }
};

Way make_way(generate::Scene& scene, const generate::SceneConfig& config) {
    scene.config = config;
    Way way;
    way.draper = generate::make_draper(scene);
    way.neutral = way.draper->drape_neutral();
    return way;
}

/// The configured way and those of the variants that can be had.
struct Ways {
    Way configured;
    std::vector<Way> variant;
};

Ways make_ways(generate::Scene& scene, files::NoiseHeader& header) {
    const generate::SceneConfig config = scene.config;
    Ways ways;
    ways.configured = make_way(scene, config);
    if (!ways.configured.neutral.position.allFinite())
        throw Error("the garment cannot be draped in the neutral pose", config.file);
    for (const NoiseVariant& variant : noise_variants(config)) {
        try {
            ways.variant.push_back(make_way(scene, variant.config));
            header.variant.push_back({variant.name, variant.what});
        } catch (const Error& error) {
            header.missing.push_back(variant.name + ": not available: " + error.what());
        }
    }
    scene.config = config;
    return ways;
}

/// Largest of the distances of the variants that count; NaN where none does.
Eigen::VectorXd spread_of(const files::NoiseRecord& record) {
    Eigen::VectorXd spread = Eigen::VectorXd::Constant(record.cloth.rows(), not_a_number);
    if (record.status != 0) return spread;
    for (const files::NoiseRecord::Variant& one : record.variant) {
        if (one.status != 0) continue;
        for (Eigen::Index v = 0; v < spread.size(); ++v)
            if (!(spread[v] > one.distance[v])) spread[v] = one.distance[v];
    }
    return spread;
}

/// A sample as it is stored, and how long its drapes took: the configured one first.
struct Draped {
    files::NoiseRecord record;
    std::vector<double> seconds;
};

Draped drape_sample(const Ways& ways, const NoiseSource::Pose& pose) {
    Draped draped;
    files::NoiseRecord& record = draped.record;
    const DrapeResult configured = ways.configured.drape(pose);
    record.id = pose.id;
    record.status = static_cast<int>(configured.status);
    record.cloth = configured.position;
    draped.seconds.push_back(configured.certificate.seconds);
    for (const Way& way : ways.variant) {
        const DrapeResult other = way.drape(pose);
        record.variant.push_back(
            {static_cast<int>(other.status), other.position, (other.position - configured.position).rowwise().norm()});
        draped.seconds.push_back(other.certificate.seconds);
    }
    record.spread = spread_of(record);
    record.spread_rms = std::sqrt(record.spread.squaredNorm() / static_cast<double>(record.spread.size()));
    record.spread_max = record.spread.hasNaN() ? not_a_number : record.spread.maxCoeff();
    return draped;
}

files::NoiseHeader noise_header(const generate::SceneConfig& config, double share) {
    files::NoiseHeader header;
    header.config = config.text;
    header.config_hash = config.hash;
    header.program_version = TOILE_VERSION;
    header.seed = static_cast<std::int64_t>(config.seed);
    header.share = share;
    for (const std::string_view reason : simulate::status_reasons()) header.reasons.emplace_back(reason);
    return header;
}

/// Drapes the chosen poses, a few for each thread at a time, and hands each on in order.
void drape_all(const NoiseOptions& options, const NoiseSource& source, const std::vector<int>& chosen, const Ways& ways,
               const std::function<void(Draped)>& take) {
    const int count = static_cast<int>(chosen.size()), block = 4 * options.jobs;
    std::vector<Draped> draped(static_cast<size_t>(block));
    for (int first = 0; first < count; first += block) {
        const int here = std::min(block, count - first);
        if (options.progress) options.progress({"draping", first, count, 0});
        parallel_for(here, options.jobs, [&](int, int k) {
            if (options.interrupted && *options.interrupted)
                throw generate::Interrupted("interrupted: no noise floor was written");
            draped[k] = drape_sample(ways, source.pose[chosen[first + k]]);
        });
        for (int k = 0; k < here; ++k) take(std::move(draped[k]));
    }
}

void check(const NoiseOptions& options) {
    if (!(options.share > 0.0 && options.share <= 1.0))
        throw Error("the share of the poses is above 0 and at most 1", "--share");
    if (options.jobs < 1) throw Error("one job at least", "--jobs");
}

}  // namespace

std::vector<NoiseVariant> noise_variants(const generate::SceneConfig& config) {
    std::vector<NoiseVariant> variant;
    const auto add = [&](const char* name, const std::string& what) -> generate::SceneConfig& {
        return variant.emplace_back(NoiseVariant{name, what, config}).config;
    };
    generate::SceneConfig& half = add("half_step", "half the time step and half the joint step");
    half.solver.time_step *= 0.5;
    half.path.joint_step *= 0.5;
    generate::SceneConfig& fine = add("fine_tolerance", "a tenth of the tolerances of rest and of path steps");
    fine.solver.residual_tolerance *= 0.1;
    fine.solver.max_iterations *= 4;
    fine.path.path_tolerance *= 0.1;
    fine.path.path_iterations *= 4;
    const std::string second = config.solver.solver == "xpbd" ? "implicit" : "xpbd";
    add("second_solver", "the solver " + second).solver.solver = second;
    return variant;
}

NoiseSummary measure_noise(const NoiseOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    check(options);
    const NoiseSource source = read_noise_source(options.source, options.overrides);
    const generate::OutputFolder folder(options.folder, generate::OutputFolder::For::results);
    const std::vector<int> chosen =
        drawn_share(static_cast<int>(source.pose.size()), options.share, source.config.seed);

    if (options.progress) options.progress({"dressing the body in its neutral pose", 0, 0, 0});
    generate::Scene scene = generate::build_scene(source.config);
    files::NoiseHeader header = noise_header(source.config, options.share);
    const Ways ways = make_ways(scene, header);
    header.mesh = scene.garment.mesh;
    header.mesh.rest_position = ways.configured.neutral.position;

    NoiseSummary summary;
    summary.file = folder.file("noise.h5");
    summary.results = folder.file("noise.json");
    summary.poses = static_cast<int>(source.pose.size());
    summary.samples = static_cast<int>(chosen.size());
    summary.vertices = header.mesh.vertex_count();
    summary.missing = header.missing;
    files::NoiseWriter writer(summary.file, header, summary.samples);
    NoiseResults results(header.variant);
    drape_all(options, source, chosen, ways, [&](Draped draped) {
        writer.write(draped.record);
        results.add(draped.record, draped.seconds);
    });
    results.summarise(summary);
    writer.finish();
    summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    results.write(summary, header, source.config);
    return summary;
}

}  // namespace toile::evaluate
