#include "files/hdf5_claim.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "cloth/error.h"
#include "files/hdf5_handle.h"

namespace toile::files {
namespace {

constexpr int64_t gzip_ratio = 1040;
constexpr int64_t never_written = 1 << 20;               // [bytes]
constexpr int64_t virtual_selection = int64_t{1} << 30;  // [bytes]

int64_t file_size(hid_t object) {
    const Handle file(H5Iget_file_id(object), H5Fclose);
    hsize_t size = 0;
    if (!file.valid() || H5Fget_filesize(file, &size) < 0) return 0;
    return static_cast<int64_t>(std::min<hsize_t>(size, hsize_t{1} << 50));
}

[[noreturn]] void refuse_claim(int64_t count) {
    throw Error("it claims to hold " + std::to_string(count) + " values, more than its file can");
}

/// Compared by division: a product may wrap around.
void check_size(int64_t count, size_t width, int64_t room) {
    if (count < 0 || (width > 0 && count > room / static_cast<int64_t>(width))) refuse_claim(count);
}

void check_filters(hid_t creation) {
    std::vector<H5Z_filter_t> seen;
    for (int i = 0; i < H5Pget_nfilters(creation); ++i) {
        unsigned flags = 0, options = 0;
        size_t values = 0;
        std::array<char, 64> name{};
        const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values, nullptr,
                                                   name.size() - 1, name.data(), &options);
        const bool known =
            filter == H5Z_FILTER_SHUFFLE || filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_FLETCHER32;
        if (!known)
            throw Error("it is stored with the HDF5 filter " + std::to_string(filter) + ", which is not read", {},
                        "store it with gzip, or without compression");
        if (std::find(seen.begin(), seen.end(), filter) != seen.end())
            throw Error("it is stored with the HDF5 filter " + std::to_string(filter) + " twice");
        seen.push_back(filter);
    }
}

int64_t chunk_elements(hid_t creation) {
    std::array<hsize_t, H5S_MAX_RANK> size{};
    const int rank = H5Pget_chunk(creation, size.size(), size.data());
    return element_count(Shape(size.begin(), size.begin() + std::max(rank, 0)));
}

int64_t extent_elements(hid_t dataset) {
    const Handle space(H5Dget_space(dataset), H5Sclose);
    std::array<hsize_t, H5S_MAX_RANK> size{};
    const int rank = H5Sget_simple_extent_dims(space, size.data(), nullptr);
    return element_count(Shape(size.begin(), size.begin() + std::max(rank, 0)));
}

void check_sources(hid_t creation, const std::string& path) {
    namespace fs = std::filesystem;
    size_t count = 0;
    H5Pget_virtual_count(creation, &count);
    for (size_t i = 0; i < count; ++i) {
        std::string name(4096, '\0');
        const ssize_t size = H5Pget_virtual_filename(creation, i, name.data(), name.size());
        name.resize(static_cast<size_t>(std::clamp<ssize_t>(size, 0, 4095)));
        std::error_code failure;
        const fs::path beside = fs::path(path).parent_path() / name;
        if (name == "." || fs::equivalent(name, path, failure) || fs::equivalent(beside, path, failure))
            throw Error("it is made up of datasets of its own file, which is not read");
    }
}

}  // namespace

int64_t element_count(const Shape& shape) {
    if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
    int64_t count = 1;
    for (const int64_t size : shape) {
        if (size < 0 || count > std::numeric_limits<int64_t>::max() / size)
            throw Error("it claims to have shape " + shape_text(shape));
        count *= size;
    }
    return count;
}

bool check_claim(hid_t dataset, const std::string& path) {
    const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    const Handle type(H5Dget_type(dataset), H5Tclose);
    const H5D_layout_t layout = H5Pget_layout(creation);
    if (layout == H5D_VIRTUAL) {
        check_sources(creation, path);
        return true;
    }
    if (H5Pget_external_count(creation) > 0) throw Error("its values lie in another file, which is not read");
    check_filters(creation);
    const int64_t room = never_written + file_size(dataset) * (layout == H5D_CHUNKED ? gzip_ratio : 1);
    check_size(extent_elements(dataset), H5Tget_size(type), room);
    // HDF5 reads values that lie in the header as far as the shape says.
    if (layout == H5D_COMPACT)
        check_size(extent_elements(dataset), H5Tget_size(type), static_cast<int64_t>(H5Dget_storage_size(dataset)));
    if (layout == H5D_CHUNKED) check_size(chunk_elements(creation), H5Tget_size(type), room);
    return false;
}

void check_virtual_selection(int64_t count, size_t width) {
    check_size(count, width, virtual_selection);
}

void check_stored_claim(hid_t object, int64_t count, size_t width) {
    check_size(count, width, file_size(object));
}

}  // namespace toile::files
