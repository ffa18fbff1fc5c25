#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <type_traits>

#include "cloth/error.h"
#include "files/hdf5_claim.h"
#include "files/hdf5_file.h"
#include "files/hdf5_handle.h"

namespace toile::files {
namespace {

constexpr size_t most_open_parts = 8;

/// The rows [first, second) that are selected, or nothing where the selection is not whole rows one after the other.
std::optional<std::pair<int64_t, int64_t>> selected_rows(hid_t space) {
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1) return std::nullopt;
    const auto dimensions = static_cast<size_t>(rank);
    std::vector<hsize_t> size(dimensions), start(dimensions), end(dimensions);
    if (H5Sget_simple_extent_dims(space, size.data(), nullptr) < 0) return std::nullopt;
    if (H5Sget_select_bounds(space, start.data(), end.data()) < 0) return std::nullopt;
    hsize_t count = end[0] - start[0] + 1;
    for (size_t i = 1; i < dimensions; ++i) {
        if (start[i] != 0 || end[i] + 1 != size[i]) return std::nullopt;
        count *= size[i];
    }
    if (H5Sget_select_npoints(space) != static_cast<hssize_t>(count)) return std::nullopt;
    return std::pair(static_cast<int64_t>(start[0]), static_cast<int64_t>(end[0]) + 1);
}

std::string text_of(const std::function<ssize_t(char*, size_t)>& get) {
    const ssize_t length = get(nullptr, 0);
    if (length < 0) return {};
    std::string text(static_cast<size_t>(length) + 1, '\0');
    get(text.data(), text.size());
    text.resize(static_cast<size_t>(length));
    return text;
}

/// The mappings of a virtual dataset as rows one after the other; empty if they are anything else.
std::vector<VirtualRows> rows_of(hid_t creation, const Shape& shape) {
    size_t count = 0;
    if (H5Pget_virtual_count(creation, &count) < 0 || shape.empty()) return {};
    std::vector<VirtualRows> part;
    int64_t next = 0;
    for (size_t i = 0; i < count; ++i) {
        const Handle shown(H5Pget_virtual_vspace(creation, i), H5Sclose);
        const Handle source(H5Pget_virtual_srcspace(creation, i), H5Sclose);
        const auto here = selected_rows(shown), there = selected_rows(source);
        if (!here || !there || here->first != next || here->second - here->first != there->second - there->first)
            return {};
        next = here->second;
        part.push_back(
            {text_of([&](char* text, size_t size) { return H5Pget_virtual_filename(creation, i, text, size); }),
             text_of([&](char* text, size_t size) { return H5Pget_virtual_dsetname(creation, i, text, size); }),
             there->first, there->second - there->first});
        if (part.back().file == "." || part.back().file.find('%') != std::string::npos) return {};
    }
    return next == shape[0] ? part : std::vector<VirtualRows>{};
}

}  // namespace

const VirtualDataset* Hdf5File::Impl::virtual_dataset(const std::string& name, hid_t dataset) {
    if (const auto known = virtuals.find(name); known != virtuals.end()) return &known->second;
    const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    if (H5Pget_layout(creation) != H5D_VIRTUAL) return nullptr;
    if (is_part) fail("a virtual dataset refers to another virtual dataset", name);
    const Shape found = shape(Handle(H5Dget_space(dataset), H5Sclose));
    return &virtuals.insert_or_assign(name, VirtualDataset{found, rows_of(creation, found)}).first->second;
}

std::string Hdf5File::Impl::part_path(const VirtualRows& part) const {
    return (std::filesystem::path(path).parent_path() / part.file).string();
}

const Hdf5File& Hdf5File::Impl::part_file(const std::string& name, const VirtualRows& part) {
    const std::string found = part_path(part);
    for (auto one = open.begin(); one != open.end(); ++one) {
        if (one->first != found) continue;
        open.splice(open.begin(), open, one);
        return open.front().second;
    }
    try {
        open.emplace_front(found, Hdf5File::open(found));
    } catch (const Error& error) {
        throw Error("a part of the data cannot be read, " + part.file + ": " + error.what(), where(name),
                    "put it back where it was, or join what is there with toile merge");
    }
    open.front().second.impl_->is_part = true;
    if (open.size() > most_open_parts) open.pop_back();
    return open.front().second;
}

std::vector<VirtualRows> Hdf5File::virtual_rows(const std::string& name) const {
    const Session session;
    const VirtualDataset* found = impl_->virtual_dataset(name, impl_->dataset(name));
    return found ? found->part : std::vector<VirtualRows>{};
}

std::vector<std::string> Hdf5File::unreadable_parts(const std::string& name) const {
    std::vector<std::string> line;
    std::set<std::string> checked;
    int64_t start = 0;
    for (const VirtualRows& part : virtual_rows(name)) {
        try {
            if (checked.insert(part.file).second) open(impl_->part_path(part));
        } catch (const Error& error) {
            line.push_back("rows " + std::to_string(start) + " and on are in " + part.file + ": " + error.what());
        }
        start += part.rows;
    }
    return line;
}

template <typename T>
void Hdf5File::create_virtual_rows(const std::string& name, const Shape& row_shape,
                                   const std::vector<VirtualRows>& part) {
    const Session session;
    Shape shape{0}, source_shape{0};
    for (const VirtualRows& one : part) shape[0] += one.rows;
    shape.insert(shape.end(), row_shape.begin(), row_shape.end());
    source_shape.insert(source_shape.end(), row_shape.begin(), row_shape.end());
    const Handle space = dataspace(shape), list = untimed_dataset();
    const T missing = std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : T{0};
    H5Pset_fill_value(list, native_type<T>(), &missing);
    int64_t next = 0;
    for (const VirtualRows& one : part) {
        source_shape[0] = one.first + one.rows;
        const Handle source = dataspace(source_shape);
        select_rows(source, source_shape, one.first, one.rows);
        select_rows(space, shape, next, one.rows);
        if (H5Pset_virtual(list, space, one.file.c_str(), one.dataset.c_str(), source) < 0)
            impl_->fail("cannot refer to " + one.file + ": " + library_message(), name);
        next += one.rows;
    }
    make_groups(impl_->file, name);
    H5Sselect_all(space);
    Handle dataset(H5Dcreate2(impl_->file, name.c_str(), native_type<T>(), space, H5P_DEFAULT, list, H5P_DEFAULT),
                   H5Dclose);
    if (!dataset.valid()) impl_->fail("cannot create the dataset: " + library_message(), name);
    dataset.close();
    impl_->check_written();
}

template <typename T>
Array<T> Hdf5File::read_parts(const std::string& name, const VirtualDataset& whole, int64_t first,
                              int64_t count) const {
    check_rows(whole.shape, first, count);
    Array<T> array{{}, whole.shape};
    array.shape[0] = count;
    check_virtual_selection(element_count(array.shape), sizeof(T));
    array.value.reserve(static_cast<size_t>(element_count(array.shape)));
    int64_t start = 0;
    for (const VirtualRows& part : whole.part) {
        const int64_t from = std::max(first, start), to = std::min(first + count, start + part.rows);
        if (from < to) {
            const Hdf5File& source = impl_->part_file(name, part);
            const Array<T> rows = source.read_rows<T>(part.dataset, part.first + from - start, to - from);
            Shape expected = whole.shape;
            expected[0] = to - from;
            if (rows.shape != expected)
                throw Error(
                    "has rows of shape " + shape_text(rows.shape) + " where " + shape_text(expected) + " is expected",
                    source.path() + ":" + part.dataset);
            array.value.insert(array.value.end(), rows.value.begin(), rows.value.end());
        }
        start += part.rows;
    }
    return array;
}

#define TOILE_ELEMENT_TYPE(T)                                                                                     \
    template Array<T> Hdf5File::read_parts<T>(const std::string&, const VirtualDataset&, int64_t, int64_t) const; \
    template void Hdf5File::create_virtual_rows<T>(const std::string&, const Shape&, const std::vector<VirtualRows>&);
TOILE_ELEMENT_TYPE(float)
TOILE_ELEMENT_TYPE(double)
TOILE_ELEMENT_TYPE(int8_t)
TOILE_ELEMENT_TYPE(uint8_t)
TOILE_ELEMENT_TYPE(int16_t)
TOILE_ELEMENT_TYPE(int32_t)
TOILE_ELEMENT_TYPE(int64_t)
#undef TOILE_ELEMENT_TYPE

}  // namespace toile::files
