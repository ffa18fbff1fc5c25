#include "generate/validate_noise.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/error.h"
#include "files/noise_file.h"
#include "generate/file_structure.h"

namespace toile::generate {
namespace {

using Lines = std::vector<std::string>;

/// The datasets of a file with these variants. Names live as long as `name`.
std::vector<Feature> noise_table(const std::vector<std::string>& variants, std::vector<std::string>& name) {
    std::vector<Feature> table{
        {"mesh", true, {{"/mesh/triangle", "int32", "F 3"}, {"/mesh/rest_position", "float64", "V 3"}}},
        {"pattern", false, {{"/mesh/pattern_position", "float64", "P 2"}, {"/mesh/pattern_triangle", "int32", "F 3"}}},
        {"mass", false, {{"/mesh/mass", "float64", "V"}}},
        {"samples",
         true,
         {{"/samples/id", "int64", "N"},
          {"/samples/cloth", "float64", "N V 3"},
          {"/samples/status", "int8", "N"},
          {"/samples/spread", "float64", "N V"},
          {"/samples/spread_rms", "float64", "N"},
          {"/samples/spread_max", "float64", "N"}}}};
    name.reserve(3 * variants.size());  // the table keeps pointers into it
    for (const std::string& variant : variants) {
        const char* status = name.emplace_back("/samples/" + variant + "_status").c_str();
        const char* distance = name.emplace_back("/samples/" + variant + "_distance").c_str();
        const char* cloth = name.emplace_back("/samples/" + variant + "_cloth").c_str();
        table.push_back(
            {"variant", true, {{status, "int8", "N"}, {distance, "float64", "N V"}, {cloth, "float32", "N V 3"}}});
    }
    return table;
}

Lines structure_of(const std::string& path) {
    const files::Hdf5File file = files::Hdf5File::open(path);
    files::check_noise_version(file, path);
    Lines defect;
    try {
        std::vector<std::string> name;
        check_structure(file, noise_table(file.strings_attribute("/", "variants"), name), defect);
    } catch (const Error& error) {
        defect.push_back(std::string("/: ") + error.what());
    }
    return defect;
}

bool known(int status, const files::NoiseHeader& header) {
    return status >= 0 && status < static_cast<int>(header.reasons.size());
}

/// Both not a number, or the same to rounding.
bool same(double a, double b) {
    return std::isnan(a) ? std::isnan(b) : std::abs(a - b) <= 1e-12 * std::max(1.0, std::abs(b));
}

/// Largest distance over the accepted variants at vertex v, NaN where none counts.
double spread_at(const files::NoiseRecord& record, Eigen::Index v) {
    double largest = std::numeric_limits<double>::quiet_NaN();
    for (const files::NoiseRecord::Variant& one : record.variant)
        if (record.status == 0 && one.status == 0 && !(largest > one.distance[v])) largest = one.distance[v];
    return largest;
}

/// Distances between two cloths of which one is stored in single precision: how far they may be from what was stored.
double rounding(const Positions& cloth) {
    return 4.0 * std::numeric_limits<float>::epsilon() * std::max(1e-3, cloth.cwiseAbs().maxCoeff());
}

/// The first thing that is wrong with a variant of an accepted sample, or nothing.
std::string defect_of(const files::NoiseRecord& record, const files::NoiseRecord::Variant& one,
                      const std::string& name) {
    if (!one.distance.allFinite() || one.distance.minCoeff() < 0.0)
        return fmt::format("{} is accepted, but a distance is negative or not finite", name);
    if (!one.cloth.allFinite()) return fmt::format("{} is accepted, but its cloth is not finite", name);
    const Eigen::VectorXd distance = (one.cloth - record.cloth).rowwise().norm();
    if ((distance - one.distance).cwiseAbs().maxCoeff() > rounding(one.cloth))
        return fmt::format("the distances of {} are not those of its cloth", name);
    return {};
}

/// The first thing that is wrong with a sample, or nothing.
std::string defect_of(const files::NoiseHeader& header, const files::NoiseRecord& record) {
    if (!known(record.status, header)) return fmt::format("status {} has no reason", record.status);
    if (record.status == 0 && !record.cloth.allFinite()) return "is accepted, but its cloth is not finite";
    for (size_t k = 0; k < header.variant.size(); ++k) {
        const files::NoiseRecord::Variant& one = record.variant[k];
        const std::string& name = header.variant[k].name;
        if (!known(one.status, header)) return fmt::format("{}_status {} has no reason", name, one.status);
        if (record.status != 0 || one.status != 0) continue;
        if (const std::string defect = defect_of(record, one, name); !defect.empty()) return defect;
    }
    for (Eigen::Index v = 0; v < record.spread.size(); ++v)
        if (!same(record.spread[v], spread_at(record, v)))
            return fmt::format("the spread at vertex {} is not the largest of its distances", v);
    const double rms = std::sqrt(record.spread.squaredNorm() / static_cast<double>(record.spread.size()));
    if (!same(record.spread_rms, rms)) return "spread_rms is not the root mean square of its spread";
    if (!same(record.spread_max, record.spread.hasNaN() ? std::nan("") : record.spread.maxCoeff()))
        return "spread_max is not the largest of its spread";
    return {};
}

}  // namespace

Validation validate_noise(const std::string& path, const ValidateOptions& options) {
    Validation result;
    result.defect = structure_of(path);
    if (!result.defect.empty()) return result;
    try {
        const files::NoiseReader reader(path);
        check_cloth_mesh(reader.header().mesh, "");
        result.samples = static_cast<int>(reader.sample_count());
        for (int slot = 0; slot < result.samples; ++slot) {
            const files::NoiseRecord record = reader.read(slot);
            if (slot > 0 && record.id <= reader.read(slot - 1).id)
                result.defect.push_back(fmt::format("/samples/id[{}]: does not ascend", slot));
            const std::string defect = defect_of(reader.header(), record);
            if (!defect.empty()) result.defect.push_back(fmt::format("/samples[{}]: {}", slot, defect));
            result.accepted += record.status == 0 && defect.empty();
            if (options.step) options.step(slot + 1, result.samples);
        }
    } catch (const Error& error) {  // a chunk that cannot be read: the file is ours, but damaged
        result.defect.push_back(error.what());
    }
    return result;
}

}  // namespace toile::generate
