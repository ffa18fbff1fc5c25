#pragma once

#include <hdf5.h>

#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::files {

/// Owns one HDF5 identifier.
class Handle {
  public:
    using Closer = herr_t (*)(hid_t);
    Handle() = default;
    Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(closer_, other.closer_);
        return *this;
    }
    ~Handle() { close(); }
    herr_t close() { return id_ < 0 ? 0 : closer_(std::exchange(id_, -1)); }
    operator hid_t() const { return id_; }
    bool valid() const { return id_ >= 0; }

  private:
    hid_t id_ = -1;
    Closer closer_ = nullptr;
};

/// Held during every call into HDF5: one thread at a time, and the library does not print its error stack.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// In a child process that was forked within a session: its thread has another number than the lock's holder.
    static void start_in_child();

  private:
    std::unique_lock<std::recursive_mutex> lock_;
    H5E_auto2_t print_ = nullptr;
    void* print_data_ = nullptr;
};

/// The innermost message of HDF5's error stack.
std::string library_message();

/// A virtual dataset whose parts follow each other, row by row, from first to last.
struct VirtualDataset {
    Shape shape;
    std::vector<VirtualRows> part;  ///< empty where it is made up in another way
};

struct Hdf5File::Impl {
    std::string path;
    int write_error = 0;  ///< set by the watched driver
    Handle file;
    bool writable = false;
    mutable std::map<std::string, bool> checked;       ///< datasets whose claims were looked into; true: virtual
    bool is_part = false;                              ///< opened for a virtual dataset of another file
    std::map<std::string, VirtualDataset> virtuals;    ///< those of a file that is read, by name, as they were met
    std::list<std::pair<std::string, Hdf5File>> open;  ///< parts by path, the one used last in front

    std::string where(const std::string& name) const { return path + ":" + name; }
    [[noreturn]] void fail(const std::string& what, const std::string& name) const;
    /// Error if a write did not reach the disk.
    void check_written() const;
    Handle dataset(const std::string& name) const;
    /// Throws Error, without a place, where the dataset claims too much for `count` values of `width` bytes to be read.
    void check_claims(hid_t dataset, const std::string& name, int64_t count, size_t width) const;
    /// What is known of a virtual dataset; null if `dataset` is none.
    const VirtualDataset* virtual_dataset(const std::string& name, hid_t dataset);
    std::string part_path(const VirtualRows& part) const;
    /// The file that holds rows of a virtual dataset. Error if it cannot be read.
    const Hdf5File& part_file(const std::string& name, const VirtualRows& part);
    /// The group or dataset that carries attributes.
    Handle object(const std::string& name) const;
    Shape shape(hid_t space) const;
};

/// A list that makes datasets without timestamps: the bytes of a file depend on its content alone.
Handle untimed_dataset();

/// Makes the groups above `name`; those that HDF5 makes by itself would carry timestamps.
void make_groups(hid_t file, const std::string& name);

/// Sets the rows [first, first + count) of a dataspace of this shape as its selection.
void select_rows(hid_t space, const Shape& shape, int64_t first, int64_t count);

/// Error unless a dataset of this shape has the rows [first, first + count).
void check_rows(const Shape& shape, int64_t first, int64_t count);

Handle dataspace(const Shape& shape);

/// HDF5's name for an element type in memory.
template <typename T>
hid_t native_type();

/// Strings as they are written: UTF-8 of one fixed length, padded with zero bytes. Those of variable length would lie
/// in HDF5's global heap, which has no checksum: the library crashes where it is damaged.
struct FixedStrings {
    explicit FixedStrings(const std::vector<std::string>& value);
    size_t width = 1;
    std::vector<char> text;
    Handle type;
};

/// "float32", "int8", "string" ... of a stored type.
std::string type_text(hid_t type);

/// All strings of a dataset or attribute, of variable or fixed length; `read` fills a buffer of the type it is given.
std::vector<std::string> strings_of(hid_t stored_type, hid_t space, const std::function<herr_t(hid_t, void*)>& read);

}  // namespace toile::files
