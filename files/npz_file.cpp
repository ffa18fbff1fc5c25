#include "files/npz_file.h"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

/// Beyond this a member's sizes do not fit the fields of plain zip.
constexpr uint64_t plain_zip_limit = 0xf0000000;

std::string python_tuple(const Shape& shape) {
    std::string text = "(";
    for (const int64_t size : shape) text += std::to_string(size) + ",";
    return text + ")";
}

/// The NPY 1.0 header: a Python dictionary on one line, padded so that the data starts at a multiple of 64.
std::string npy_header(const std::string& type, const Shape& shape) {
    std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + python_tuple(shape) + ", }";
    text.append(63 - (10 + text.size()) % 64, ' ');
    text += '\n';
    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(text.size() & 0xff);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

/// The bytes of one element, from the digits of its type.
uint64_t element_size(const std::string& type) {
    return std::stoull(type.substr(2));
}

template <typename T>
const char* type_of();
template <>
const char* type_of<float>() {
    return "<f4";
}
template <>
const char* type_of<double>() {
    return "<f8";
}
template <>
const char* type_of<int8_t>() {
    return "|i1";
}
template <>
const char* type_of<int32_t>() {
    return "<i4";
}
template <>
const char* type_of<int64_t>() {
    return "<i8";
}

}  // namespace

struct NpzWriter::Impl {
    explicit Impl(const std::string& path) : file(path), zip(zipOpen64(file.partial().c_str(), APPEND_STATUS_CREATE)) {
        if (!zip) fail();
    }
    ~Impl() {
        if (zip) zipClose(zip, nullptr);
    }

    [[noreturn]] void fail() const {
        throw Error("cannot write the file: " + write_failure(errno != 0 ? errno : EIO), file.path(),
                    "make room, or write to another disk");
    }
    void check(int outcome) const {
        if (outcome != ZIP_OK) fail();
    }
    void put(const char* data, uint64_t size) {
        constexpr uint64_t piece = 1 << 24;  // the library takes 32-bit sizes
        for (uint64_t done = 0; done < size; done += piece)
            check(zipWriteInFileInZip(zip, data + done, static_cast<unsigned>(std::min(piece, size - done))));
    }
    void end_array() {
        if (missing != 0) throw std::logic_error("an array of an .npz file is not complete");
        if (open) check(zipCloseFileInZip(zip));
        open = false;
    }

    NewFile file;
    zipFile zip;
    bool open = false;
    uint64_t missing = 0;  ///< bytes the array begun last still lacks
};

NpzWriter::NpzWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
NpzWriter::~NpzWriter() = default;

void NpzWriter::begin(const std::string& name, const std::string& type, const Shape& shape) {
    Impl& impl = *impl_;
    impl.end_array();
    uint64_t bytes = element_size(type);
    for (const int64_t size : shape) bytes *= static_cast<uint64_t>(size);
    zip_fileinfo info{};
    info.dosDate = 0x21 << 16;  // 1980-01-01, zip's first day: no file tells when it was written
    errno = 0;
    impl.check(zipOpenNewFileInZip64(impl.zip, (name + ".npy").c_str(), &info, nullptr, 0, nullptr, 0, nullptr, 0, 0,
                                     bytes > plain_zip_limit));
    impl.open = true;
    const std::string header = npy_header(type, shape);
    impl.put(header.data(), header.size());
    impl.missing = bytes;
}

void NpzWriter::append(const void* data, size_t bytes) {
    if (bytes > impl_->missing) throw std::logic_error("an array of an .npz file gets more than its shape holds");
    errno = 0;
    impl_->put(static_cast<const char*>(data), bytes);
    impl_->missing -= bytes;
}

template <typename T>
void NpzWriter::add(const std::string& name, const std::vector<T>& value, const Shape& shape) {
    begin(name, type_of<T>(), shape);
    append(value.data(), value.size() * sizeof(T));
}
template void NpzWriter::add(const std::string&, const std::vector<float>&, const Shape&);
template void NpzWriter::add(const std::string&, const std::vector<double>&, const Shape&);
template void NpzWriter::add(const std::string&, const std::vector<int8_t>&, const Shape&);
template void NpzWriter::add(const std::string&, const std::vector<int32_t>&, const Shape&);
template void NpzWriter::add(const std::string&, const std::vector<int64_t>&, const Shape&);

void NpzWriter::add_strings(const std::string& name, const std::vector<std::string>& value) {
    size_t length = 1;
    for (const std::string& text : value) length = std::max(length, text.size());
    begin(name, "|S" + std::to_string(length), {static_cast<int64_t>(value.size())});
    for (std::string text : value) {
        text.resize(length, '\0');
        append(text.data(), length);
    }
}

void NpzWriter::commit() {
    errno = 0;
    impl_->end_array();
    zipFile zip = std::exchange(impl_->zip, nullptr);
    impl_->check(zipClose(zip, nullptr));
    impl_->file.commit();
}

}  // namespace toile::files
