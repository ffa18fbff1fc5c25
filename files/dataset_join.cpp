#include "files/dataset_join.h"

#include <filesystem>
#include <vector>

#include "cloth/error.h"
#include "files/dataset_columns.h"
#include "files/dataset_header.h"
#include "files/new_file.h"

namespace toile::files {

struct DatasetJoin::Impl {
    Impl(const std::string& path, const DatasetHeader& shared, int count, How as)
        : header(shared), sample_count(count), how(as), target(path), file(Hdf5File::create(target.partial())) {}

    const DatasetHeader header;
    const int sample_count;
    const How how;
    NewFile target;
    Hdf5File file;
    std::unique_ptr<DatasetColumns> columns;
    std::vector<VirtualRows> rows;  ///< where the samples lie, without the name of a dataset

    void copy(const DatasetReader& part, int row);
    void refer(const DatasetReader& part, int row);
    void create_virtual();
};

void DatasetJoin::Impl::copy(const DatasetReader& part, int row) {
    for_each_array(header, [&](const char* name, auto zero, const Shape&) {
        file.copy_row<decltype(zero)>(name, columns->count(), part.file(), row);
    });
}

void DatasetJoin::Impl::refer(const DatasetReader& part, int row) {
    const std::filesystem::path folder = std::filesystem::absolute(target.path()).parent_path();
    const std::string relative = std::filesystem::absolute(part.file().path()).lexically_relative(folder).string();
    if (!rows.empty() && rows.back().file == relative && rows.back().first + rows.back().rows == row)
        ++rows.back().rows;
    else
        rows.push_back({relative, {}, row, 1});
}

void DatasetJoin::Impl::create_virtual() {
    for_each_array(header, [&](const char* name, auto zero, const Shape& row) {
        for (VirtualRows& one : rows) one.dataset = name;
        file.create_virtual_rows<decltype(zero)>(name, row, rows);
    });
}

DatasetJoin::DatasetJoin(const std::string& path, const DatasetHeader& header, int sample_count, int deflate, How how)
    : impl_(std::make_unique<Impl>(path, header, sample_count, how)) {
    Hdf5File& file = impl_->file;
    write_dataset_header(file, header, deflate);
    if (how == How::copy)
        for_each_array(header, [&](const char* name, auto zero, const Shape& row) {
            file.create_rows<decltype(zero)>(name, sample_count, row, deflate);
        });
    impl_->columns = std::make_unique<DatasetColumns>(file, path, impl_->header, sample_count, false);
}

DatasetJoin::~DatasetJoin() = default;

void DatasetJoin::add(const DatasetReader& part, int row, const SampleRecord& columns, const Digest& digest) {
    if (impl_->columns->count() == impl_->sample_count)
        throw Error("there is no place for sample " + std::to_string(columns.id), impl_->target.path());
    if (impl_->how == How::copy)
        impl_->copy(part, row);
    else
        impl_->refer(part, row);
    impl_->columns->add(columns, digest);
}

void DatasetJoin::finish() {
    if (impl_->columns->count() != impl_->sample_count)
        throw Error("sample " + std::to_string(impl_->columns->count()) + " of " + std::to_string(impl_->sample_count) +
                        " was never added",
                    impl_->target.path());
    if (impl_->how == How::refer) impl_->create_virtual();
    impl_->columns->finish();
    impl_->file.close();
    impl_->columns->commit();
    impl_->target.commit();
}

}  // namespace toile::files
