#include <hdf5.h>

#include <algorithm>
#include <functional>
#include <type_traits>

#include "cloth/error.h"
#include "files/hdf5_claim.h"
#include "files/hdf5_file.h"
#include "files/hdf5_handle.h"

namespace toile::files {
namespace {

std::vector<hsize_t> sizes(const Shape& shape) {
    return {shape.begin(), shape.end()};
}

Handle dataset_creation(const Shape& chunk, int deflate) {
    Handle list = untimed_dataset();
    if (chunk.empty()) return list;
    H5Pset_chunk(list, static_cast<int>(chunk.size()), sizes(chunk).data());
    if (deflate > 0) {
        H5Pset_shuffle(list);
        H5Pset_deflate(list, static_cast<unsigned>(deflate));
    }
    H5Pset_fletcher32(list);
    return list;
}

template <typename T>
void check_kind(const std::string& stored) {
    const bool fits = std::is_floating_point_v<T> ? stored.rfind("float", 0) == 0
                                                  : stored.rfind("int", 0) == 0 || stored.rfind("uint", 0) == 0;
    if (!fits)
        throw Error(std::string("holds ") + stored + " where " +
                    (std::is_floating_point_v<T> ? "floating point numbers are" : "integers are") + " expected");
}

/// Integers of another width come through int64, so that none is clipped unseen.
template <typename T>
std::vector<T> read_selected(hid_t dataset, hid_t memory, hid_t space, int64_t count) {
    const Handle type(H5Dget_type(dataset), H5Tclose);
    check_kind<T>(type_text(type));
    std::vector<T> value(static_cast<size_t>(count));
    if (count == 0) return value;
    if constexpr (!std::is_floating_point_v<T>) {
        const bool sign = H5Tget_sign(type) == H5T_SGN_2;
        if (H5Tget_size(type) > sizeof(T) || sign != std::is_signed_v<T>) {
            std::vector<int64_t> wide(value.size());
            if (H5Dread(dataset, H5T_NATIVE_INT64, memory, space, H5P_DEFAULT, wide.data()) < 0)
                throw Error("cannot be read: " + library_message());
            for (size_t i = 0; i < wide.size(); ++i) {
                value[i] = static_cast<T>(wide[i]);
                if (static_cast<int64_t>(value[i]) != wide[i])
                    throw Error("holds " + std::to_string(wide[i]) + ", out of range");
            }
            return value;
        }
    }
    if (H5Dread(dataset, native_type<T>(), memory, space, H5P_DEFAULT, value.data()) < 0)
        throw Error("cannot be read: " + library_message());
    return value;
}

/// Runs `task`, adding to an Error where it happened.
template <typename Task>
auto located(const std::string& where, const Task& task) {
    try {
        return task();
    } catch (const Error& error) {
        throw Error(error.where().empty() ? where.substr(where.rfind(':') + 1) + " " + error.what() : error.what(),
                    error.where().empty() ? where : error.where(), error.mend());
    }
}

}  // namespace

Handle dataspace(const Shape& shape) {
    if (shape.empty()) return Handle(H5Screate(H5S_SCALAR), H5Sclose);
    return Handle(H5Screate_simple(static_cast<int>(shape.size()), sizes(shape).data(), nullptr), H5Sclose);
}

Handle untimed_dataset() {
    Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(list, false);
    return list;
}

void make_groups(hid_t file, const std::string& name) {
    for (size_t end = name.find('/', 1); end != std::string::npos; end = name.find('/', end + 1)) {
        const std::string group = name.substr(0, end);
        if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
        const Handle list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
        H5Pset_obj_track_times(list, false);
        const Handle made(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, list, H5P_DEFAULT), H5Gclose);
    }
}

void select_rows(hid_t space, const Shape& shape, int64_t first, int64_t count) {
    std::vector<hsize_t> start(shape.size(), 0);
    std::vector<hsize_t> size = sizes(shape);
    start[0] = static_cast<hsize_t>(first);
    size[0] = static_cast<hsize_t>(count);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
}

void check_rows(const Shape& shape, int64_t first, int64_t count) {
    if (shape.empty() || first < 0 || count < 0 || first > shape[0] - count)
        throw Error("has no rows " + std::to_string(first) + " to " + std::to_string(first + count - 1));
}

template <>
hid_t native_type<float>() {
    return H5T_NATIVE_FLOAT;
}
template <>
hid_t native_type<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native_type<int8_t>() {
    return H5T_NATIVE_INT8;
}
template <>
hid_t native_type<uint8_t>() {
    return H5T_NATIVE_UINT8;
}
template <>
hid_t native_type<int16_t>() {
    return H5T_NATIVE_INT16;
}
template <>
hid_t native_type<int32_t>() {
    return H5T_NATIVE_INT32;
}
template <>
hid_t native_type<int64_t>() {
    return H5T_NATIVE_INT64;
}

template <typename T>
Array<T> Hdf5File::read(const std::string& name) const {
    const Session session;
    return located(impl_->where(name), [&] {
        const Handle dataset = impl_->dataset(name);
        const Handle space(H5Dget_space(dataset), H5Sclose);
        Shape shape = impl_->shape(space);
        const VirtualDataset* parts = impl_->virtual_dataset(name, dataset);
        if (parts && !parts->part.empty()) return read_rows<T>(name, 0, shape[0]);
        impl_->check_claims(dataset, name, element_count(shape), sizeof(T));
        return Array<T>{read_selected<T>(dataset, H5S_ALL, H5S_ALL, element_count(shape)), std::move(shape)};
    });
}

template <typename T>
Array<T> Hdf5File::read(const std::string& name, const Shape& expected) const {
    const Shape found = shape(name);
    bool same = found.size() == expected.size();
    for (size_t i = 0; same && i < found.size(); ++i) same = expected[i] == any_size || expected[i] == found[i];
    if (!same) impl_->fail(name + " has shape " + shape_text(found) + ", not " + shape_text(expected), name);
    return read<T>(name);
}

template <typename T>
Array<T> Hdf5File::read_rows(const std::string& name, int64_t first, int64_t count) const {
    const Session session;
    return located(impl_->where(name), [&] {
        // to open a virtual dataset takes as long as it has parts
        const auto known = impl_->virtuals.find(name);
        if (known != impl_->virtuals.end() && !known->second.part.empty())
            return read_parts<T>(name, known->second, first, count);
        const Handle dataset = impl_->dataset(name);
        const Handle space(H5Dget_space(dataset), H5Sclose);
        Shape shape = impl_->shape(space);
        check_rows(shape, first, count);
        const VirtualDataset* parts = impl_->virtual_dataset(name, dataset);
        if (parts && !parts->part.empty()) return read_parts<T>(name, *parts, first, count);
        select_rows(space, shape, first, count);
        shape[0] = count;
        impl_->check_claims(dataset, name, element_count(shape), sizeof(T));
        const Handle memory = dataspace(shape);
        return Array<T>{read_selected<T>(dataset, memory, space, element_count(shape)), std::move(shape)};
    });
}

std::vector<std::string> Hdf5File::read_strings(const std::string& name) const {
    const Session session;
    return located(impl_->where(name), [&] {
        const Handle dataset = impl_->dataset(name);
        const Handle space(H5Dget_space(dataset), H5Sclose);
        const Handle type(H5Dget_type(dataset), H5Tclose);
        if (H5Tget_class(type) != H5T_STRING) throw Error("holds " + type_text(type) + " where strings are expected");
        const int64_t count = element_count(impl_->shape(space));
        impl_->check_claims(dataset, name, count, H5Tget_size(type));
        if (H5Tis_variable_str(type) > 0) check_stored_claim(dataset, count, H5Tget_size(type));
        return strings_of(type, space, [&](hid_t memory, void* buffer) {
            return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
        });
    });
}

template <typename T>
void Hdf5File::write(const std::string& name, const T* value, const Shape& shape, const Storage& storage) {
    const Session session;
    Shape chunk = storage.chunk.empty() ? shape : storage.chunk;
    if (storage.deflate < 0 || element_count(shape) == 0) chunk.clear();
    make_groups(impl_->file, name);
    const Handle space = dataspace(shape);
    const Handle list = dataset_creation(chunk, storage.deflate);
    Handle dataset(H5Dcreate2(impl_->file, name.c_str(), native_type<T>(), space, H5P_DEFAULT, list, H5P_DEFAULT),
                   H5Dclose);
    if (!dataset.valid()) impl_->fail("cannot create the dataset: " + library_message(), name);
    if (element_count(shape) > 0 && H5Dwrite(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0)
        impl_->fail("cannot write: " + library_message(), name);
    dataset.close();
    impl_->check_written();
}

void Hdf5File::write_strings(const std::string& name, const std::vector<std::string>& value) {
    const Session session;
    const FixedStrings strings(value);
    const Shape shape{static_cast<int64_t>(value.size())};
    make_groups(impl_->file, name);
    const Handle space = dataspace(shape);
    const Handle list = dataset_creation(value.empty() ? Shape{} : shape, 0);
    Handle dataset(H5Dcreate2(impl_->file, name.c_str(), strings.type, space, H5P_DEFAULT, list, H5P_DEFAULT),
                   H5Dclose);
    if (!dataset.valid()) impl_->fail("cannot create the dataset: " + library_message(), name);
    if (!value.empty() && H5Dwrite(dataset, strings.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, strings.text.data()) < 0)
        impl_->fail("cannot write: " + library_message(), name);
    dataset.close();
    impl_->check_written();
}

template <typename T>
void Hdf5File::create_rows(const std::string& name, int64_t rows, const Shape& row_shape, int deflate,
                           int64_t rows_per_chunk) {
    const Session session;
    if (rows_per_chunk == 0) rows_per_chunk = row_shape.empty() ? 4096 : 1;
    const int64_t chunk_rows = std::clamp<int64_t>(rows, 1, rows_per_chunk);
    Shape shape{rows}, chunk{chunk_rows};
    shape.insert(shape.end(), row_shape.begin(), row_shape.end());
    chunk.insert(chunk.end(), row_shape.begin(), row_shape.end());
    std::vector<hsize_t> largest = sizes(shape);
    largest[0] = H5S_UNLIMITED;
    make_groups(impl_->file, name);
    const Handle space(H5Screate_simple(static_cast<int>(shape.size()), sizes(shape).data(), largest.data()), H5Sclose);
    const Handle list = dataset_creation(chunk, deflate);
    Handle dataset(H5Dcreate2(impl_->file, name.c_str(), native_type<T>(), space, H5P_DEFAULT, list, H5P_DEFAULT),
                   H5Dclose);
    if (!dataset.valid()) impl_->fail("cannot create the dataset: " + library_message(), name);
    dataset.close();
    impl_->check_written();
}

template <typename T>
void Hdf5File::write_rows(const std::string& name, int64_t first, int64_t count, const T* value) {
    const Session session;
    Handle dataset = impl_->dataset(name);
    Handle space(H5Dget_space(dataset), H5Sclose);
    Shape shape = impl_->shape(space);
    if (shape.empty() || first < 0 || count < 0) impl_->fail("has no row " + std::to_string(first), name);
    if (count == 0) return;
    if (first + count > shape[0]) {
        shape[0] = first + count;
        if (H5Dset_extent(dataset, sizes(shape).data()) < 0) impl_->fail("cannot be extended", name);
        space = Handle(H5Dget_space(dataset), H5Sclose);
    }
    select_rows(space, shape, first, count);
    shape[0] = count;
    const Handle memory = dataspace(shape);
    if (H5Dwrite(dataset, native_type<T>(), memory, space, H5P_DEFAULT, value) < 0)
        impl_->fail("cannot write: " + library_message(), name);
    dataset.close();
    impl_->check_written();
}

void Hdf5File::remove(const std::string& name) {
    const Session session;
    impl_->virtuals.erase(name);
    if (H5Ldelete(impl_->file, name.c_str(), H5P_DEFAULT) < 0) impl_->fail("cannot remove: no such dataset", name);
    impl_->check_written();
}

void Hdf5File::link(const std::string& name, const std::string& file, const std::string& dataset) {
    const Session session;
    make_groups(impl_->file, name);
    if (H5Lcreate_external(file.c_str(), dataset.c_str(), impl_->file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0)
        impl_->fail("cannot link: " + library_message(), name);
    impl_->check_written();
}

template <typename T>
void Hdf5File::write_row(const std::string& name, int64_t row, const T* value) {
    write_rows(name, row, 1, value);
}

#define TOILE_ELEMENT_TYPE(T)                                                                        \
    template Array<T> Hdf5File::read<T>(const std::string&) const;                                   \
    template Array<T> Hdf5File::read<T>(const std::string&, const Shape&) const;                     \
    template Array<T> Hdf5File::read_rows<T>(const std::string&, int64_t, int64_t) const;            \
    template void Hdf5File::write<T>(const std::string&, const T*, const Shape&, const Storage&);    \
    template void Hdf5File::create_rows<T>(const std::string&, int64_t, const Shape&, int, int64_t); \
    template void Hdf5File::write_rows<T>(const std::string&, int64_t, int64_t, const T*);           \
    template void Hdf5File::write_row<T>(const std::string&, int64_t, const T*);
TOILE_ELEMENT_TYPE(float)
TOILE_ELEMENT_TYPE(double)
TOILE_ELEMENT_TYPE(int8_t)
TOILE_ELEMENT_TYPE(uint8_t)
TOILE_ELEMENT_TYPE(int16_t)
TOILE_ELEMENT_TYPE(int32_t)
TOILE_ELEMENT_TYPE(int64_t)
#undef TOILE_ELEMENT_TYPE

}  // namespace toile::files
