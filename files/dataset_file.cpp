#include "files/dataset_file.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "cloth/error.h"
#include "files/dataset_columns.h"
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
void add(RunningDigest& digest, const std::vector<T>& value) {
    digest.add(value.data(), value.size() * sizeof(T));
}

}  // namespace

Digest sample_digest(const SampleRecord& sample) {
    RunningDigest digest;
    digest.add(&sample.id, sizeof sample.id);
    const int8_t small[] = {static_cast<int8_t>(sample.split), static_cast<int8_t>(sample.status)};
    digest.add(small, sizeof small);
    digest.add(sample.pose.data(), static_cast<size_t>(sample.pose.size()) * sizeof(double));
    add(digest, floats(sample.cloth));
    add(digest, floats(sample.embedded));
    add(digest, floats(sample.displacement));
    add(digest, quaternion_floats(sample.frame));
    add(digest, sample.image);
    const std::string certificate = certificate_bytes(sample.certificate);
    digest.add(certificate.data(), certificate.size());
    return digest.value();
}

std::string timing_path(const std::string& dataset) {
    return std::filesystem::path(dataset).replace_extension(".timing.h5").string();
}

struct DatasetWriter::Impl {
    Impl(const std::string& path, const DatasetHeader& shared, int count)
        : header(shared), sample_count(count), target(path), file(Hdf5File::create(target.partial())) {}

    const DatasetHeader header;
    const int sample_count;
    NewFile target;
    Hdf5File file;
    std::unique_ptr<DatasetColumns> columns;
    int next_slot = 0;
    std::map<int, SampleRecord> early;  ///< slot -> sample that waits for the ones before it

    void check(const SampleRecord& sample, int slot) const;
    void store(const SampleRecord& sample);
    [[noreturn]] void fail(const std::string& what) const { throw Error(what, target.path()); }
};

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
    columns->add(sample, sample_digest(sample));
}

DatasetWriter::DatasetWriter(const std::string& path, const DatasetHeader& header, int sample_count, int deflate,
                             const std::optional<CorpusPart>& part)
    : impl_(std::make_unique<Impl>(path, header, sample_count)) {
    Hdf5File& file = impl_->file;
    write_dataset_header(file, header, deflate);
    if (part) write_part(file, *part);
    for_each_array(header, [&](const char* name, auto zero, const Shape& row) {
        file.create_rows<decltype(zero)>(name, sample_count, row, deflate);
    });
    impl_->columns = std::make_unique<DatasetColumns>(file, path, impl_->header, sample_count, part.has_value());
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
    impl_->columns->finish();
    impl_->file.close();
    impl_->columns->commit();
    impl_->target.commit();
}

}  // namespace toile::files
