#include <hdf5.h>

#include <algorithm>
#include <array>

#include "cloth/error.h"
#include "files/hdf5_claim.h"
#include "files/hdf5_file.h"
#include "files/hdf5_handle.h"

namespace toile::files {
namespace {

struct Filter {
    H5Z_filter_t id;
    unsigned flags;
    std::vector<unsigned> parameter;
    bool operator==(const Filter&) const = default;
};

std::vector<Filter> filters(hid_t creation) {
    std::vector<Filter> filter;
    for (int i = 0; i < H5Pget_nfilters(creation); ++i) {
        std::array<unsigned, 16> parameter{};
        size_t count = parameter.size();
        unsigned flags = 0, config = 0;
        const H5Z_filter_t id =
            H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &count, parameter.data(), 0, nullptr, &config);
        count = std::min(count, parameter.size());
        filter.push_back({id, flags, {parameter.begin(), parameter.begin() + static_cast<std::ptrdiff_t>(count)}});
    }
    return filter;
}

/// Whether a row of one can be stored in the other as it is: of one type, a chunk, and through the same filters.
bool stored_alike(hid_t a, hid_t b) {
    const Handle type_a(H5Dget_type(a), H5Tclose), type_b(H5Dget_type(b), H5Tclose);
    const Handle list_a(H5Dget_create_plist(a), H5Pclose), list_b(H5Dget_create_plist(b), H5Pclose);
    if (H5Tequal(type_a, type_b) <= 0 || H5Pget_layout(list_a) != H5D_CHUNKED || H5Pget_layout(list_b) != H5D_CHUNKED)
        return false;
    std::array<hsize_t, H5S_MAX_RANK> chunk_a{}, chunk_b{};
    const int rank = H5Pget_chunk(list_a, H5S_MAX_RANK, chunk_a.data());
    if (rank != H5Pget_chunk(list_b, H5S_MAX_RANK, chunk_b.data()) || chunk_a != chunk_b || chunk_a[0] != 1)
        return false;
    return filters(list_a) == filters(list_b);
}

/// Error unless the row lies in the dataset.
std::vector<hsize_t> chunk_offset(const Shape& shape, int64_t row) {
    if (shape.empty() || row < 0 || row >= shape[0]) throw Error("has no row " + std::to_string(row));
    std::vector<hsize_t> offset(shape.size(), 0);
    offset[0] = static_cast<hsize_t>(row);
    return offset;
}

}  // namespace

int Hdf5File::deflate(const std::string& name) const {
    const Session session;
    const Handle creation(H5Dget_create_plist(impl_->dataset(name)), H5Pclose);
    if (H5Pget_layout(creation) != H5D_CHUNKED) return -1;
    for (const Filter& one : filters(creation))
        if (one.id == H5Z_FILTER_DEFLATE && !one.parameter.empty()) return static_cast<int>(one.parameter[0]);
    return 0;
}

template <typename T>
void Hdf5File::copy_row(const std::string& name, int64_t row, const Hdf5File& source, int64_t source_row) {
    const Session session;
    Handle to = impl_->dataset(name);
    const Handle from = source.impl_->dataset(name);
    const Shape shape = impl_->shape(Handle(H5Dget_space(to), H5Sclose));
    const Shape source_shape = source.impl_->shape(Handle(H5Dget_space(from), H5Sclose));
    if (Shape(shape.begin() + 1, shape.end()) != Shape(source_shape.begin() + 1, source_shape.end()))
        impl_->fail("has rows of another shape than " + source.impl_->where(name), name);
    const std::vector<hsize_t> there = chunk_offset(source_shape, source_row), here = chunk_offset(shape, row);
    hsize_t size = 0;
    if (!stored_alike(from, to) || H5Dget_chunk_storage_size(from, there.data(), &size) < 0 || size == 0) {
        to.close();
        write_row(name, row, source.read_rows<T>(name, source_row, 1).value.data());
        return;
    }
    check_stored_claim(from, static_cast<int64_t>(std::min<hsize_t>(size, hsize_t{1} << 62)), 1);
    std::vector<unsigned char> bytes(size);
    uint32_t mask = 0;
    if (H5Dread_chunk(from, H5P_DEFAULT, there.data(), &mask, bytes.data()) < 0)
        source.impl_->fail("cannot be read: " + library_message(), name);
    if (H5Dwrite_chunk(to, H5P_DEFAULT, mask, here.data(), size, bytes.data()) < 0)
        impl_->fail("cannot write: " + library_message(), name);
    to.close();
    impl_->check_written();
}

#define TOILE_ELEMENT_TYPE(T) \
    template void Hdf5File::copy_row<T>(const std::string&, int64_t, const Hdf5File&, int64_t);
TOILE_ELEMENT_TYPE(float)
TOILE_ELEMENT_TYPE(double)
TOILE_ELEMENT_TYPE(int8_t)
TOILE_ELEMENT_TYPE(uint8_t)
TOILE_ELEMENT_TYPE(int16_t)
TOILE_ELEMENT_TYPE(int32_t)
TOILE_ELEMENT_TYPE(int64_t)
#undef TOILE_ELEMENT_TYPE

}  // namespace toile::files
