#include "files/noise_file.h"

#include <utility>

#include "cloth/error.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr int deflate = 0;  // checksums, no compression: distances are noise

std::string status_name(const NoiseVariant& variant) {
    return "/samples/" + variant.name + "_status";
}
std::string cloth_name(const NoiseVariant& variant) {
    return "/samples/" + variant.name + "_cloth";
}
std::string distance_name(const NoiseVariant& variant) {
    return "/samples/" + variant.name + "_distance";
}

void write_root(Hdf5File& file, const NoiseHeader& header) {
    std::vector<std::string> name, what;
    for (const NoiseVariant& variant : header.variant) {
        name.push_back(variant.name);
        what.push_back(variant.what);
    }
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", noise_version);
    file.set_attribute("/", "kind", "noise");
    file.set_attribute("/", "config", header.config);
    file.set_attribute("/", "config_hash", header.config_hash);
    file.set_attribute("/", "program_version", header.program_version);
    file.set_attribute("/", "seed", header.seed);
    file.set_attribute("/", "share", header.share);
    file.set_attribute("/", "reasons", header.reasons);
    file.set_attribute("/", "variants", name);
    file.set_attribute("/", "variant_meanings", what);
    if (!header.missing.empty()) file.set_attribute("/", "missing_variants", header.missing);
}

using FloatPositions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

Positions as_positions(const std::vector<float>& value) {
    return Eigen::Map<const FloatPositions>(value.data(), static_cast<Eigen::Index>(value.size() / 3), 3)
        .cast<double>();
}
Positions as_positions(const std::vector<double>& value) {
    return Eigen::Map<const Positions>(value.data(), static_cast<Eigen::Index>(value.size() / 3), 3);
}
Eigen::VectorXd as_column(const std::vector<double>& value) {
    return Eigen::Map<const Eigen::VectorXd>(value.data(), static_cast<Eigen::Index>(value.size()));
}

}  // namespace

void check_noise_version(const Hdf5File& file, const std::string& path) {
    if (!file.has_attribute("/", "kind") || file.string_attribute("/", "kind") != "noise")
        throw Error("this is not a noise file", path + ":/", "toile evaluate noise writes them");
    const int64_t version = file.integer_attribute("/", "version");
    if (version != noise_version)
        throw Error("the noise file has version " + std::to_string(version) + ", not " + std::to_string(noise_version),
                    path + ":/", "measure it anew: toile evaluate noise");
}

struct NoiseWriter::Impl {
    Impl(const std::string& path, const NoiseHeader& from, int64_t count)
        : variant(from.variant),
          vertices(from.mesh.vertex_count()),
          sample_count(count),
          target(path),
          file(Hdf5File::create(target.partial())) {
        write_root(file, from);
        write_mesh_group(file, from.mesh, deflate);
        file.create_rows<int64_t>("/samples/id", count, {}, deflate);
        file.create_rows<double>("/samples/cloth", count, {vertices, 3}, deflate);
        file.create_rows<int8_t>("/samples/status", count, {}, deflate);
        for (const NoiseVariant& one : variant) {
            file.create_rows<int8_t>(status_name(one), count, {}, deflate);
            file.create_rows<float>(cloth_name(one), count, {vertices, 3}, deflate);
            file.create_rows<double>(distance_name(one), count, {vertices}, deflate);
        }
        file.create_rows<double>("/samples/spread", count, {vertices}, deflate);
        for (const char* name : {"/samples/spread_rms", "/samples/spread_max"})
            file.create_rows<double>(name, count, {}, deflate);
    }

    const std::vector<NoiseVariant> variant;
    const int64_t vertices, sample_count;
    NewFile target;
    Hdf5File file;
    int64_t next = 0;

    void write_status(const std::string& name, int status) {
        const auto stored = static_cast<int8_t>(status);
        file.write_row(name, next, &stored);
    }
    void check(const NoiseRecord& record) const {
        bool fits = next < sample_count && record.cloth.rows() == vertices && record.spread.size() == vertices &&
                    record.variant.size() == variant.size();
        for (const NoiseRecord::Variant& one : record.variant)
            fits = fits && one.distance.size() == vertices && one.cloth.rows() == vertices;
        if (!fits) throw Error("sample " + std::to_string(next) + " does not fit the file", target.path());
    }
};

NoiseWriter::NoiseWriter(const std::string& path, const NoiseHeader& header, int64_t sample_count)
    : impl_(std::make_unique<Impl>(path, header, sample_count)) {}
NoiseWriter::~NoiseWriter() = default;

void NoiseWriter::write(const NoiseRecord& record) {
    Impl& to = *impl_;
    to.check(record);
    to.file.write_row("/samples/id", to.next, &record.id);
    to.file.write_row("/samples/cloth", to.next, record.cloth.data());
    to.write_status("/samples/status", record.status);
    for (size_t k = 0; k < to.variant.size(); ++k) {
        to.write_status(status_name(to.variant[k]), record.variant[k].status);
        const FloatPositions cloth = record.variant[k].cloth.cast<float>();
        to.file.write_row(cloth_name(to.variant[k]), to.next, cloth.data());
        to.file.write_row(distance_name(to.variant[k]), to.next, record.variant[k].distance.data());
    }
    to.file.write_row("/samples/spread", to.next, record.spread.data());
    to.file.write_row("/samples/spread_rms", to.next, &record.spread_rms);
    to.file.write_row("/samples/spread_max", to.next, &record.spread_max);
    ++to.next;
}

void NoiseWriter::finish() {
    if (impl_->next != impl_->sample_count)
        throw Error("sample " + std::to_string(impl_->next) + " of " + std::to_string(impl_->sample_count) +
                        " was never written",
                    impl_->target.path());
    impl_->file.close();
    impl_->target.commit();
}

NoiseReader::NoiseReader(const std::string& path) : file_(Hdf5File::open(path)) {
    check_noise_version(file_, path);
    const auto strings = [&](const char* key) { return file_.strings_attribute("/", key); };
    header_.mesh = read_mesh_group(file_);
    const std::vector<std::string> name = strings("variants"), what = strings("variant_meanings");
    if (name.size() != what.size()) throw Error("variants and variant_meanings differ in number", path + ":/");
    for (size_t k = 0; k < name.size(); ++k) header_.variant.push_back({name[k], what[k]});
    if (file_.has_attribute("/", "missing_variants")) header_.missing = strings("missing_variants");
    header_.reasons = strings("reasons");
    header_.config = file_.string_attribute("/", "config");
    header_.config_hash = file_.string_attribute("/", "config_hash");
    header_.program_version = file_.string_attribute("/", "program_version");
    header_.seed = file_.integer_attribute("/", "seed");
    header_.share = file_.number_attribute("/", "share");
    const Shape spread = file_.shape("/samples/spread");
    if (spread.size() != 2 || spread[1] != header_.mesh.vertex_count())
        throw Error("/samples/spread has shape " + shape_text(spread) + ", not " +
                        shape_text({any_size, header_.mesh.vertex_count()}),
                    path + ":/samples/spread");
    sample_count_ = spread[0];
}

NoiseRecord NoiseReader::read(int64_t slot) const {
    const auto row = [&](const std::string& name) { return file_.read_rows<double>(name, slot, 1).value; };
    const auto status = [&](const std::string& name) { return file_.read_rows<int8_t>(name, slot, 1).value.at(0); };
    NoiseRecord record;
    record.id = file_.read_rows<int64_t>("/samples/id", slot, 1).value.at(0);
    record.cloth = as_positions(row("/samples/cloth"));
    record.status = status("/samples/status");
    for (const NoiseVariant& one : header_.variant)
        record.variant.push_back({status(status_name(one)),
                                  as_positions(file_.read_rows<float>(cloth_name(one), slot, 1).value),
                                  as_column(row(distance_name(one)))});
    record.spread = as_column(row("/samples/spread"));
    record.spread_rms = row("/samples/spread_rms").at(0);
    record.spread_max = row("/samples/spread_max").at(0);
    return record;
}

}  // namespace toile::files
