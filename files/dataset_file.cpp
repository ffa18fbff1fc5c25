#include "files/dataset_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "cloth/error.h"
#include "files/dataset_header.h"
#include "files/digest.h"
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

namespace {

/// Rows of the columns that are written at a time; their chunks hold as many.
constexpr int64_t block_rows = 4096;

std::vector<double> seconds_of(const std::vector<CertificateRecord>& certificate) {
    std::vector<double> seconds;
    for (const CertificateRecord& one : certificate) seconds.push_back(one.seconds);
    return seconds;
}

/// One value a sample, or a few, of samples that follow each other.
struct ColumnBlock {
    int64_t first = 0;
    std::vector<int64_t> id;
    std::vector<int8_t> split, status;
    std::vector<uint8_t> digest;           ///< `[n x 16]`
    std::vector<double> resampling_error;  ///< `[n x 2]`
    std::vector<CertificateRecord> certificate;

    int64_t count() const { return static_cast<int64_t>(id.size()); }
    void add(const SampleRecord& sample) {
        id.push_back(sample.id);
        split.push_back(static_cast<int8_t>(sample.split));
        status.push_back(static_cast<int8_t>(sample.status));
        const Digest of_sample = sample_digest(sample);
        digest.insert(digest.end(), of_sample.begin(), of_sample.end());
        resampling_error.insert(resampling_error.end(), sample.resampling_error.begin(), sample.resampling_error.end());
        certificate.push_back(sample.certificate);
    }
};

/// Largest and root mean square over the accepted samples, which have equally many vertices.
struct GatheredError {
    double largest = 0, squared_sum = 0;
    int64_t count = 0;

    void add(const SampleRecord& sample) {
        if (sample.status != 0) return;
        largest = std::max(largest, sample.resampling_error[0]);
        squared_sum += sample.resampling_error[1] * sample.resampling_error[1];
        ++count;
    }
    std::vector<double> value() const {
        return {largest, count > 0 ? std::sqrt(squared_sum / static_cast<double>(count)) : 0.0};
    }
};

/// The file beside a data set that takes what no run repeats.
struct TimingFile {
    explicit TimingFile(const std::string& path, int64_t rows)
        : target(path), file(Hdf5File::create(target.partial())) {
        file.create_rows<double>("/seconds", rows, {}, 0, block_rows);
    }
    NewFile target;
    Hdf5File file;
};

}  // namespace

struct DatasetWriter::Impl {
    Impl(const std::string& path, const DatasetHeader& shared, int count, int level)
        : header(shared), sample_count(count), deflate(level), target(path), file(Hdf5File::create(target.partial())) {}

    const DatasetHeader header;
    const int sample_count;
    const int deflate;
    NewFile target;
    Hdf5File file;
    std::optional<TimingFile> timing;  ///< not for a part
    int next_slot = 0;
    std::map<int, SampleRecord> early;  ///< slot -> sample that waits for the ones before it
    ColumnBlock block;
    GatheredError error;
    bool certificates_created = false;

    void create_datasets(bool part);
    void check(const SampleRecord& sample, int slot) const;
    void store(const SampleRecord& sample);
    void write_block();
    void write_attributes();
    [[noreturn]] void fail(const std::string& what) const { throw Error(what, target.path()); }
};

void DatasetWriter::Impl::create_datasets(bool part) {
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
        file.create_rows<double>("/samples/resampling_error", sample_count, {2}, 0, block_rows);
    }
    file.create_rows<int64_t>("/samples/id", sample_count, {}, 0, block_rows);
    file.create_rows<int8_t>("/samples/split", sample_count, {}, 0, block_rows);
    file.create_rows<int8_t>("/samples/status", sample_count, {}, 0, block_rows);
    file.create_rows<uint8_t>("/samples/digest", sample_count, {16}, 0, block_rows);
    if (part) {
        file.create_rows<double>("/certificate/seconds", sample_count, {}, 0, block_rows);
        return;
    }
    const std::filesystem::path path = timing_path(target.path());
    timing.emplace(path.string(), sample_count);
    file.link("/certificate/seconds", path.filename().string(), "/seconds");
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
    block.add(sample);
    error.add(sample);
    if (block.count() == block_rows) write_block();
}

void DatasetWriter::Impl::write_block() {
    const int64_t first = block.first, count = block.count();
    if (!certificates_created) {
        create_certificates(file, sample_count, count > 0 && block.certificate.front().detail.has_value());
        certificates_created = true;
    }
    file.write_rows("/samples/id", first, count, block.id.data());
    file.write_rows("/samples/split", first, count, block.split.data());
    file.write_rows("/samples/status", first, count, block.status.data());
    file.write_rows("/samples/digest", first, count, block.digest.data());
    if (header.image) file.write_rows("/samples/resampling_error", first, count, block.resampling_error.data());
    write_certificate_rows(file, first, block.certificate);
    const std::vector<double> seconds = seconds_of(block.certificate);
    if (timing)
        timing->file.write_rows("/seconds", first, count, seconds.data());
    else
        file.write_rows("/certificate/seconds", first, count, seconds.data());
    block = {};
    block.first = first + count;
}

void DatasetWriter::Impl::write_attributes() {
    file.set_attribute("/samples/split", "duplicate_angle", header.duplicate_angle);
    file.set_attribute("/samples/status", "reasons", header.reasons);
    for (const auto& [name, largest] : header.gate) file.set_attribute("/certificate", name, largest);
    if (!header.image) return;
    file.set_attribute("/", "resampling_error", error.value());
    file.set_attribute("/samples/image", "resampling_error", error.value());
}

DatasetWriter::DatasetWriter(const std::string& path, const DatasetHeader& header, int sample_count, int deflate,
                             const std::optional<CorpusPart>& part)
    : impl_(std::make_unique<Impl>(path, header, sample_count, deflate)) {
    write_dataset_header(impl_->file, header, deflate);
    if (part) write_part(impl_->file, *part);
    impl_->create_datasets(part.has_value());
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

void DatasetWriter::finish() {
    if (impl_->next_slot != impl_->sample_count)
        impl_->fail("slot " + std::to_string(impl_->next_slot) + " of " + std::to_string(impl_->sample_count) +
                    " was never written");
    impl_->write_block();
    impl_->write_attributes();
    impl_->file.close();
    if (impl_->timing) {
        impl_->timing->file.close();
        impl_->timing->target.commit();
    }
    impl_->target.commit();
}

}  // namespace toile::files
