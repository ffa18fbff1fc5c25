#include "files/dataset_file.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "cloth/error.h"
#include "files/digest.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

template <typename Rows>
std::vector<float> floats(const Rows& rows) {
    std::vector<float> value(static_cast<size_t>(rows.size()));
    std::transform(rows.data(), rows.data() + rows.size(), value.begin(),
                   [](double x) { return static_cast<float>(x); });
    return value;
}

std::vector<float> quaternion_floats(const std::vector<Eigen::Quaterniond>& frame) {
    std::vector<float> value;
    value.reserve(4 * frame.size());
    for (const Eigen::Quaterniond& q : frame)
        for (const double x : {q.w(), q.x(), q.y(), q.z()}) value.push_back(static_cast<float>(x));
    return value;
}

template <typename T>
void append(std::string& bytes, const T* value, size_t count) {
    bytes.append(reinterpret_cast<const char*>(value), count * sizeof(T));
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& value) {
    append(bytes, value.data(), value.size());
}

void write_body_group(Hdf5File& file, const DatasetBody& body, int deflate) {
    const Storage storage{deflate, {}};
    const auto joints = static_cast<int64_t>(body.joint_name.size());
    const auto weights = static_cast<int64_t>(body.weight_value.size());
    file.write("/body/triangle", body.triangle.data(), {body.triangle.rows(), 3}, storage);
    file.write("/body/rest_position", body.rest_position.data(), {body.rest_position.rows(), 3}, storage);
    file.write_strings("/body/joint_name", body.joint_name);
    file.write("/body/joint_parent", body.joint_parent, {joints}, storage);
    std::vector<double> bind;
    for (const Eigen::Matrix4d& matrix : body.joint_bind)
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) bind.push_back(matrix(row, column));
    file.write("/body/joint_bind", bind, {joints, 4, 4}, storage);
    file.write("/body/weight_vertex", body.weight_vertex, {weights}, storage);
    file.write("/body/weight_joint", body.weight_joint, {weights}, storage);
    file.write("/body/weight_value", body.weight_value, {weights}, storage);
}

void write_root(Hdf5File& file, const DatasetHeader& header) {
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", dataset_version);
    file.set_attribute("/", "config", header.config);
    file.set_attribute("/", "config_hash", header.config_hash);
    file.set_attribute("/", "program_version", header.program_version);
    file.set_attribute("/", "seed", header.seed);
    file.set_attribute("/", "reasons", header.reasons);
}

void write_header(Hdf5File& file, const DatasetHeader& header, int deflate) {
    const Storage storage{deflate, {}};
    write_root(file, header);
    write_mesh_group(file, header.mesh, deflate);
    if (header.body) write_body_group(file, *header.body, deflate);
    if (header.embedding) {
        const auto vertices = static_cast<int64_t>(header.embedding->triangle.size());
        file.write("/embedding/triangle", header.embedding->triangle, {vertices}, storage);
        file.write("/embedding/barycentric", header.embedding->barycentric.data(), {vertices, 3}, storage);
    }
    if (header.image) {
        const DatasetImage& image = *header.image;
        file.write("/image/pattern_pixel", image.pattern_pixel.data(), {image.pattern_pixel.rows(), 3}, storage);
        file.write("/image/mask", image.mask, {image.layers, image.size, image.size}, storage);
    }
}

}  // namespace

Digest sample_digest(const SampleRecord& sample) {
    std::string bytes;
    append(bytes, &sample.id, 1);
    const int8_t small[] = {static_cast<int8_t>(sample.split), static_cast<int8_t>(sample.status)};
    append(bytes, small, 2);
    append(bytes, sample.pose.data(), static_cast<size_t>(sample.pose.size()));
    append(bytes, floats(sample.cloth));
    append(bytes, floats(sample.embedded));
    append(bytes, floats(sample.displacement));
    append(bytes, quaternion_floats(sample.frame));
    append(bytes, sample.image);
    bytes += certificate_bytes(sample.certificate);
    const std::string text = text_digest(bytes);
    Digest digest;
    for (size_t i = 0; i < digest.size(); ++i)
        digest[i] = static_cast<uint8_t>(std::stoi(text.substr(2 * i, 2), nullptr, 16));
    return digest;
}

std::string timing_path(const std::string& dataset) {
    return std::filesystem::path(dataset).replace_extension(".timing.h5").string();
}

struct DatasetWriter::Impl {
    Impl(const std::string& path, const DatasetHeader& shared, int count, int level)
        : header(shared), sample_count(count), deflate(level), target(path), file(Hdf5File::create(target.partial())) {}

    const DatasetHeader header;
    const int sample_count;
    const int deflate;
    NewFile target;
    Hdf5File file;
    int next_slot = 0;
    std::map<int, SampleRecord> early;  ///< slot -> sample that waits for the ones before it

    // One value a sample, written at the end.
    std::vector<int64_t> id;
    std::vector<int8_t> split, status;
    std::vector<uint8_t> digest;
    std::vector<CertificateRecord> certificate;

    void create_datasets();
    void check(const SampleRecord& sample, int slot) const;
    void store(const SampleRecord& sample);
    void write_certificates();
    void write_timing(const NewFile& timing) const;
    void write_columns();
    [[noreturn]] void fail(const std::string& what) const { throw Error(what, target.path()); }
};

void DatasetWriter::Impl::create_datasets() {
    const int64_t vertices = header.mesh.vertex_count();
    file.create_rows<float>("/samples/cloth", sample_count, {vertices, 3}, deflate);
    if (header.body) {
        const auto joints = static_cast<int64_t>(header.body->joint_name.size());
        file.create_rows<double>("/samples/pose", sample_count, {joints, 3}, deflate);
    }
    if (header.embedding) {
        file.create_rows<float>("/samples/embedded", sample_count, {vertices, 3}, deflate);
        file.create_rows<float>("/samples/displacement", sample_count, {vertices, 3}, deflate);
        file.create_rows<float>("/samples/frame", sample_count, {vertices, 4}, deflate);
    }
    if (header.image) {
        const DatasetImage& image = *header.image;
        file.create_rows<float>("/samples/image", sample_count, {3 * image.layers, image.size, image.size}, deflate);
    }
}

void DatasetWriter::Impl::check(const SampleRecord& sample, int slot) const {
    auto expect = [&](const char* name, int64_t found, int64_t expected) {
        if (found != expected)
            fail("sample " + std::to_string(slot) + " has " + std::to_string(found) + " values of " + name + ", not " +
                 std::to_string(expected));
    };
    const int64_t vertices = header.mesh.vertex_count();
    const int64_t carried = header.embedding ? vertices : 0;
    expect("cloth", sample.cloth.rows(), vertices);
    expect("pose", sample.pose.rows(), header.body ? static_cast<int64_t>(header.body->joint_name.size()) : 0);
    expect("embedded", sample.embedded.rows(), carried);
    expect("displacement", sample.displacement.rows(), carried);
    expect("frame", static_cast<int64_t>(sample.frame.size()), carried);
    const int64_t pixels =
        header.image ? int64_t{3} * header.image->layers * header.image->size * header.image->size : 0;
    expect("image", static_cast<int64_t>(sample.image.size()), pixels);
    if (sample.status < 0 || sample.status >= static_cast<int>(header.reasons.size()))
        fail("sample " + std::to_string(slot) + " has status " + std::to_string(sample.status) +
             ", which has no reason");
    if (sample.split < 0 || sample.split > 2)
        fail("sample " + std::to_string(slot) + " has split " + std::to_string(sample.split));
}

void DatasetWriter::Impl::store(const SampleRecord& sample) {
    const int64_t row = next_slot++;
    file.write_row("/samples/cloth", row, floats(sample.cloth).data());
    if (header.body) file.write_row("/samples/pose", row, sample.pose.data());
    if (header.embedding) {
        file.write_row("/samples/embedded", row, floats(sample.embedded).data());
        file.write_row("/samples/displacement", row, floats(sample.displacement).data());
        file.write_row("/samples/frame", row, quaternion_floats(sample.frame).data());
    }
    if (header.image) file.write_row("/samples/image", row, sample.image.data());
    id.push_back(sample.id);
    split.push_back(static_cast<int8_t>(sample.split));
    status.push_back(static_cast<int8_t>(sample.status));
    certificate.push_back(sample.certificate);
    const Digest of_sample = sample_digest(sample);
    digest.insert(digest.end(), of_sample.begin(), of_sample.end());
}

void DatasetWriter::Impl::write_certificates() {
    files::write_certificates(file, certificate);
    const std::filesystem::path timing = timing_path(target.path());
    file.link("/certificate/seconds", timing.filename().string(), "/seconds");
    for (const auto& [name, largest] : header.gate) file.set_attribute("/certificate", name, largest);
}

void DatasetWriter::Impl::write_timing(const NewFile& timing) const {
    std::vector<double> seconds;
    for (const CertificateRecord& c : certificate) seconds.push_back(c.seconds);
    Hdf5File timing_file = Hdf5File::create(timing.partial());
    timing_file.write("/seconds", seconds, {sample_count}, Storage{0, {}});
    timing_file.close();
}

void DatasetWriter::Impl::write_columns() {
    const Storage storage{0, {}};
    file.write("/samples/id", id, {sample_count}, storage);
    file.write("/samples/split", split, {sample_count}, storage);
    file.write("/samples/status", status, {sample_count}, storage);
    file.write("/samples/digest", digest, {sample_count, 16}, storage);
    file.set_attribute("/samples/split", "duplicate_angle", header.duplicate_angle);
    file.set_attribute("/samples/status", "reasons", header.reasons);
}

DatasetWriter::DatasetWriter(const std::string& path, const DatasetHeader& header, int sample_count, int deflate)
    : impl_(std::make_unique<Impl>(path, header, sample_count, deflate)) {
    write_header(impl_->file, header, deflate);
    impl_->create_datasets();
}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::write(int slot, SampleRecord sample) {
    if (slot < 0 || slot >= impl_->sample_count) impl_->fail("there is no slot " + std::to_string(slot));
    impl_->check(sample, slot);
    if (slot < impl_->next_slot || !impl_->early.emplace(slot, std::move(sample)).second)
        impl_->fail("slot " + std::to_string(slot) + " was written before");
    for (auto first = impl_->early.begin(); first != impl_->early.end() && first->first == impl_->next_slot;
         first = impl_->early.erase(first))
        impl_->store(first->second);
}

void DatasetWriter::finish(const std::optional<std::array<double, 2>>& resampling_error) {
    if (impl_->next_slot != impl_->sample_count)
        impl_->fail("slot " + std::to_string(impl_->next_slot) + " of " + std::to_string(impl_->sample_count) +
                    " was never written");
    if (impl_->header.image && !resampling_error) impl_->fail("the images' resampling error was not given");
    impl_->write_columns();
    impl_->write_certificates();
    if (impl_->header.image) {
        const std::vector<double> error(resampling_error->begin(), resampling_error->end());
        impl_->file.set_attribute("/", "resampling_error", error);
        impl_->file.set_attribute("/samples/image", "resampling_error", error);
    }
    NewFile timing(timing_path(impl_->target.path()));
    impl_->write_timing(timing);
    impl_->file.close();
    impl_->target.commit();
    timing.commit();
}

}  // namespace toile::files
