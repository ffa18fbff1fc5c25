#include "generate/validate_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "generate/stored_body.h"
#include "simulate/certificate.h"
#include "simulate/ladder.h"
#include "simulate/self_intersection.h"

namespace toile::generate {
namespace {

constexpr double identity_tolerance = 1e-6;  // [m]
constexpr double carried_tolerance = 1e-5;   // [m]

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

/// Collects defects of one sample, each with the dataset and the slot.
class Lines {
  public:
    explicit Lines(int slot) : slot_(slot) {}
    void add(const std::string& dataset, const std::string& what) {
        line_.push_back(dataset + "[" + std::to_string(slot_) + "]: " + what);
    }
    /// One line for all `i` in [0, count) with `bad(i)`.
    bool add_if_any(const std::string& dataset, Eigen::Index count, const std::string& kind, const std::string& what,
                    const std::function<bool(Eigen::Index)>& bad) {
        Eigen::Index found = 0, first = -1;
        for (Eigen::Index i = 0; i < count; ++i) {
            if (!bad(i)) continue;
            if (found++ == 0) first = i;
        }
        if (found == 1) add(dataset, kind + " " + std::to_string(first) + " " + what);
        if (found > 1)
            add(dataset, kind + " " + std::to_string(first) + " and " + std::to_string(found - 1) + " more " + what);
        return found > 0;
    }
    std::vector<std::string> take() { return std::move(line_); }

  private:
    int slot_;
    std::vector<std::string> line_;
};

bool check_finite(const files::SampleRecord& sample, Lines& lines) {
    bool bad = false;
    auto rows = [&](const char* name, const Positions& value, const char* kind) {
        bad |= lines.add_if_any(name, value.rows(), kind, "is not finite",
                                [&](Eigen::Index i) { return !value.row(i).allFinite(); });
    };
    rows("/samples/pose", sample.pose, "joint");
    rows("/samples/cloth", sample.cloth, "vertex");
    rows("/samples/embedded", sample.embedded, "vertex");
    rows("/samples/displacement", sample.displacement, "vertex");
    bad |= lines.add_if_any("/samples/frame", static_cast<Eigen::Index>(sample.frame.size()), "vertex",
                            "is not a unit quaternion",
                            [&](Eigen::Index i) { return !(std::abs(sample.frame[i].norm() - 1) <= 1e-5); });
    bad |= lines.add_if_any("/samples/image", static_cast<Eigen::Index>(sample.image.size()), "pixel", "is not finite",
                            [&](Eigen::Index i) { return !std::isfinite(sample.image[i]); });
    return !bad;
}

void check_identity(const files::SampleRecord& sample, Lines& lines) {
    lines.add_if_any("/samples/displacement", static_cast<Eigen::Index>(sample.frame.size()), "vertex",
                     "does not give r = r̃ + q·d·q⁻¹ to 1e-6 m", [&](Eigen::Index v) {
                         const Eigen::Vector3d d = sample.displacement.row(v);
                         const Eigen::Vector3d r = sample.embedded.row(v).transpose() + sample.frame[v] * d;
                         const double off = (r - sample.cloth.row(v).transpose()).norm();
                         return !(off <= identity_tolerance);
                     });
}

double distance(const Positions& a, const Positions& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

Positions check_carried(const SampleChecker& checker, const files::SampleRecord& sample, Lines& lines) {
    CarriedBody carried = posed_as_stored(checker.header, *checker.body, sample);
    if (!(carried.distance <= carried_tolerance))
        lines.add("/samples/embedded", "lies " + number(carried.distance) + " m off the posed body");
    return std::move(carried.position);
}

void check_image(const SampleChecker& checker, const files::SampleRecord& sample, Lines& lines) {
    const files::DatasetImage& image = *checker.header.image;
    const double off =
        distance(pattern::read_image(checker.reading, sample.image, image.layers, image.size), sample.displacement);
    const double reported = (*checker.header.resampling_error)[0];
    if (!(off <= reported * (1 + 1e-3) + 1e-7))
        lines.add("/samples/image",
                  "reads back " + number(off) + " m off the displacement, resampling_error says " + number(reported));
}

struct Measured {
    const char* name;
    double value;
};

std::vector<Measured> measured(const files::CertificateRecord& c) {
    std::vector<Measured> all{{"residual_force", c.residual_force},
                              {"body_penetration", c.body_penetration},
                              {"self_intersections", static_cast<double>(c.self_intersections)},
                              {"max_stretch", c.max_stretch},
                              {"min_stretch", c.min_stretch},
                              {"max_speed", c.max_speed}};
    if (!c.detail) return all;
    all.push_back({"moving_share", c.detail->moving_share});
    all.push_back({"body_crossings", static_cast<double>(c.detail->body_crossings)});
    all.push_back({"iterations", static_cast<double>(c.detail->iterations)});
    all.push_back({"path_steps", static_cast<double>(c.detail->path_steps)});
    all.push_back({"tries", static_cast<double>(c.detail->tries)});
    all.push_back({"rung", static_cast<double>(c.detail->rung)});
    return all;
}

void check_certificate(const files::DatasetHeader& header, const files::SampleRecord& sample, Lines& lines) {
    for (const Measured& one : measured(sample.certificate)) {
        const std::string dataset = std::string("/certificate/") + one.name;
        if (!std::isfinite(one.value) || one.value < 0) lines.add(dataset, "is " + number(one.value));
        const auto bound = header.gate.find(one.name);
        if (bound != header.gate.end() && one.value > bound->second)
            lines.add(dataset, "is " + number(one.value) + ", above the gate's " + number(bound->second) +
                                   ", yet the sample is accepted");
    }
}

void check_detail(const files::CertificateDetail& detail, Lines& lines) {
    if (detail.moving_share > 1) lines.add("/certificate/moving_share", "is " + number(detail.moving_share));
    if (detail.tries < 1) lines.add("/certificate/tries", "is " + std::to_string(detail.tries));
    if (detail.rung >= simulate::rung_count)
        lines.add("/certificate/rung",
                  "is " + std::to_string(detail.rung) + ", the ladder has " + std::to_string(simulate::rung_count));
    const auto known = [](int status) { return status >= -1 && status < simulate::drape_status_count; };
    if (!std::all_of(detail.rung_status.begin(), detail.rung_status.end(), known))
        lines.add("/certificate/rung_*_status", "names no status");
    // A file without them has none of them.
    const auto tried =
        std::count_if(detail.rung_status.begin(), detail.rung_status.end(), [](int status) { return status >= 0; });
    if (tried > 0 && detail.tries >= 1 && tried != detail.tries)
        lines.add("/certificate/tries",
                  "is " + std::to_string(detail.tries) + ", but " + std::to_string(tried) + " rungs have a status");
}

void check_measured(const SampleChecker& checker, const files::SampleRecord& sample, const Positions* posed,
                    Lines& lines) {
    auto compare = [&](const char* name, double stored, double found, double tolerance) {
        if (!(std::abs(stored - found) <= tolerance))
            lines.add(std::string("/certificate/") + name,
                      "says " + number(stored) + ", but the cloth gives " + number(found));
    };
    // The cloth is stored in single precision: 1e-7 m on edges of a few millimetres.
    const auto stretch = simulate::stretch_range(checker.topology, checker.rest_length, sample.cloth);
    compare("max_stretch", sample.certificate.max_stretch, stretch.largest, 1e-3);
    compare("min_stretch", sample.certificate.min_stretch, stretch.smallest, 1e-3);
    // Rounding may make layers touch that did not, or the other way round: of few crossings or many, a few.
    const int crossings = simulate::count_self_intersections(checker.header.mesh.triangle, sample.cloth);
    compare("self_intersections", sample.certificate.self_intersections, crossings, 2 + 0.05 * crossings);
    if (!posed) return;
    const double depth = simulate::body_penetration(checker.body->triangle, *posed, sample.cloth);
    compare("body_penetration", sample.certificate.body_penetration, depth, 2e-5);
}

}  // namespace

SampleChecker::SampleChecker(const files::DatasetHeader& shared) : header(shared) {
    if (header.body) body = skinned_body(*header.body);
    topology = build_topology(header.mesh.triangle);
    rest_length = simulate::edge_rest_lengths(header.mesh, topology);
    if (!header.image) return;
    pattern::PatternLayout layout;
    layout.size = header.image->size;
    layout.layers = header.image->layers;
    layout.pattern_pixel = header.image->pattern_pixel;
    reading = pattern::reading_weights(header.mesh, layout);
}

std::vector<std::string> SampleChecker::defects(const files::SampleRecord& sample, const files::Digest& stored,
                                                int slot) const {
    Lines lines(slot);
    if (files::sample_digest(sample) != stored) lines.add("/samples/digest", "does not match the sample's bytes");
    if (sample.split < 0 || sample.split > 2) lines.add("/samples/split", "is " + std::to_string(sample.split));
    if (sample.status < 0 || sample.status >= static_cast<int>(header.reasons.size()))
        lines.add("/samples/status", "is " + std::to_string(sample.status) + ", which has no reason");
    if (sample.status != 0) return lines.take();
    check_certificate(header, sample, lines);
    if (sample.certificate.detail) check_detail(*sample.certificate.detail, lines);
    if (!check_finite(sample, lines)) return lines.take();
    std::optional<Positions> posed;
    if (header.embedding) {
        check_identity(sample, lines);
        posed = check_carried(*this, sample, lines);
    }
    if (header.image) check_image(*this, sample, lines);
    check_measured(*this, sample, posed ? &*posed : nullptr, lines);
    return lines.take();
}

}  // namespace toile::generate
