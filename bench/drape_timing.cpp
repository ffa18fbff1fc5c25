#include "bench/drape_timing.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "bench/figures.h"
#include "cloth/error.h"
#include "cloth/factorisation_unit.h"
#include "cloth/topology.h"

namespace toile::bench {
namespace {

/// Processor time of this process so far, all threads [s].
double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double quantile(std::vector<double> value, double share) {
    if (value.empty()) return no_number;
    std::sort(value.begin(), value.end());
    return value[static_cast<size_t>(std::ceil(share * static_cast<double>(value.size()) - 1e-9)) - 1];
}

double unit_milliseconds(const ClothMesh& mesh) {
    FactorisationUnit unit(build_topology(mesh.triangle).edge, mesh.rest_position);
    double least = std::numeric_limits<double>::max();
    for (int k = 0; k < 25; ++k) {
        const double start = processor_seconds();
        if (!unit.factor()) throw Error("the unit's matrix could not be factored");
        least = std::min(least, processor_seconds() - start);
    }
    return 1e3 * least;
}

void add_stages(const simulate::DrapeResult& drape, std::map<std::string, double>& stage) {
    const simulate::DrapeReport& r = drape.report;
    const std::map<std::string, double> known{{"level set", r.level_set_seconds},
                                              {"contact, residual", r.contact_seconds},
                                              {"self-contact", r.self_contact_seconds},
                                              {"assembly", r.assembly_seconds},
                                              {"factor", r.factor_seconds},
                                              {"line search", r.line_search_seconds},
                                              {"certificate", r.certificate_seconds}};
    double sum = 0.0;
    for (const auto& [name, seconds] : known) {
        stage[name] += seconds;
        sum += seconds;
    }
    stage["other"] += std::max(0.0, drape.certificate.seconds - sum);
}

void take(const simulate::DrapeResult& drape, double seconds, const Positions* reference, DrapeTiming& timing) {
    timing.seconds.push_back(seconds);
    timing.iterations += drape.report.iterations;
    if (drape.status == simulate::DrapeStatus::accepted) timing.accepted_share += 1.0;
    add_stages(drape, timing.stage);
    if (reference)
        timing.error.push_back(
            std::sqrt((drape.position - *reference).squaredNorm() / static_cast<double>(reference->rows())));
}

}  // namespace

double DrapeTiming::quantile_seconds(double share) const {
    return quantile(seconds, share);
}

double DrapeTiming::median_error() const {
    return quantile(error, 0.5);
}

DrapeTiming time_drapes(const simulate::DrapeScene& scene, const std::vector<skin::Pose>& poses, int repetitions,
                        const std::vector<Positions>& reference, std::vector<Positions>* kept) {
    DrapeTiming timing;
    timing.vertices = scene.mesh.vertex_count();
    timing.unit_milliseconds = unit_milliseconds(scene.mesh);
    try {
        const simulate::Draper draper(scene);
        const bool posed = scene.body.has_value();
        const Positions neutral = posed ? draper.drape_neutral().position : Positions();
        const size_t count = posed ? poses.size() : static_cast<size_t>(repetitions);
        for (size_t k = 0; k < count; ++k) {
            const double start = processor_seconds();
            const simulate::DrapeResult drape = posed ? draper.drape(neutral, poses[k]) : draper.drape_neutral();
            take(drape, processor_seconds() - start, reference.empty() ? nullptr : &reference[k], timing);
            if (kept) kept->push_back(drape.position);
            std::fprintf(stderr, "%d vertices, drape %zu of %zu: %.2f s, %s\n", timing.vertices, k + 1, count,
                         timing.seconds.back(), std::string(simulate::status_reason(drape.status)).c_str());
        }
    } catch (const Error& error) {
        timing.refused = error.what();
        return timing;
    }
    const auto drapes = static_cast<double>(timing.seconds.size());
    timing.iterations /= drapes;
    timing.accepted_share /= drapes;
    return timing;
}

}  // namespace toile::bench
