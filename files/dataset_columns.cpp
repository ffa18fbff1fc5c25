#include "files/dataset_columns.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "files/new_file.h"

namespace toile::files {
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
    void add(const SampleRecord& sample, const Digest& of_sample) {
        id.push_back(sample.id);
        split.push_back(static_cast<int8_t>(sample.split));
        status.push_back(static_cast<int8_t>(sample.status));
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

struct DatasetColumns::Impl {
    Impl(Hdf5File& to, const DatasetHeader& shared, int64_t count) : file(to), header(shared), sample_count(count) {}

    Hdf5File& file;
    const DatasetHeader& header;
    const int64_t sample_count;
    std::optional<TimingFile> timing;
    ColumnBlock block;
    GatheredError error;
    bool certificates_created = false;

    void create_datasets();
    void write_block();
    void write_attributes();
};

void DatasetColumns::Impl::create_datasets() {
    if (header.image) file.create_rows<double>("/samples/resampling_error", sample_count, {2}, 0, block_rows);
    file.create_rows<int64_t>("/samples/id", sample_count, {}, 0, block_rows);
    file.create_rows<int8_t>("/samples/split", sample_count, {}, 0, block_rows);
    file.create_rows<int8_t>("/samples/status", sample_count, {}, 0, block_rows);
    file.create_rows<uint8_t>("/samples/digest", sample_count, {16}, 0, block_rows);
}

void DatasetColumns::Impl::write_block() {
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

void DatasetColumns::Impl::write_attributes() {
    file.set_attribute("/samples/split", "duplicate_angle", header.duplicate_angle);
    file.set_attribute("/samples/status", "reasons", header.reasons);
    for (const auto& [name, largest] : header.gate) file.set_attribute("/certificate", name, largest);
    if (!header.image) return;
    file.set_attribute("/", "resampling_error", error.value());
    file.set_attribute("/samples/image", "resampling_error", error.value());
}

DatasetColumns::DatasetColumns(Hdf5File& file, const std::string& path, const DatasetHeader& header,
                               int64_t sample_count, bool seconds_inside)
    : impl_(std::make_unique<Impl>(file, header, sample_count)) {
    impl_->create_datasets();
    if (seconds_inside) {
        file.create_rows<double>("/certificate/seconds", sample_count, {}, 0, block_rows);
        return;
    }
    const std::string beside = timing_path(path);
    impl_->timing.emplace(beside, sample_count);
    file.link("/certificate/seconds", std::filesystem::path(beside).filename().string(), "/seconds");
}

DatasetColumns::~DatasetColumns() = default;

void DatasetColumns::add(const SampleRecord& sample, const Digest& digest) {
    impl_->block.add(sample, digest);
    impl_->error.add(sample);
    if (impl_->block.count() == block_rows) impl_->write_block();
}

int64_t DatasetColumns::count() const {
    return impl_->block.first + impl_->block.count();
}

void DatasetColumns::finish() {
    impl_->write_block();
    impl_->write_attributes();
    if (impl_->timing) impl_->timing->file.close();
}

void DatasetColumns::commit() {
    if (impl_->timing) impl_->timing->target.commit();
}

}  // namespace toile::files
