#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace toile::files {

/// Sizes along each dimension; empty for a single value. In an expected shape, `any_size` stands for any number.
using Shape = std::vector<int64_t>;
inline constexpr int64_t any_size = -1;
std::string shape_text(const Shape& shape);  ///< "(12, 3)", any_size as "*"

/// What a dataset holds, row-major.
template <typename T>
struct Array {
    std::vector<T> value;
    Shape shape;
};

/// How a dataset is laid out on the disk.
struct Storage {
    int deflate = -1;  ///< gzip level 0 to 9 with the shuffle filter before it, each chunk with a fletcher32 checksum;
                       ///< -1: contiguous, without checksum
    Shape chunk;       ///< empty: the whole dataset is one chunk
};

/// Rows [first, first + rows) of a dataset of another file, which a virtual dataset shows as its own.
struct VirtualRows {
    std::string file;  ///< relative to the folder of the file that refers to it
    std::string dataset;
    int64_t first = 0;
    int64_t rows = 0;
};

struct VirtualDataset;

/// An HDF5 file. Names of datasets are absolute paths ("/samples/cloth"); groups appear as needed.
///
/// Every failure is an Error whose `where` is "file:/dataset": missing or unreadable file, not HDF5, truncated, missing
/// dataset, wrong type or shape, damaged chunk, full disk, no permission. HDF5 itself prints nothing. Element types T:
/// float, double, int8_t, uint8_t, int16_t, int32_t, int64_t. Floating point of any width reads as float or double;
/// integers of any width read as any integer that holds their values; neither reads as the other.
///
/// A virtual dataset is read from the files it refers to, one level deep.
///
/// Strings are written as UTF-8 of one fixed length (h5py gives bytes), and read at any length.
///
/// The bytes written depend on the calls alone: no timestamps, and chunks lie in the order of the writes. The library
/// is not thread-safe as Debian builds it, so every call here holds one process-wide lock; to get the same bytes each
/// time, let one thread write.
///
///     Hdf5File file = Hdf5File::create("a.h5");
///     file.write("/samples/id", std::vector<int64_t>{1, 2}, {2});
///     file.close();  // throws if the disk was full; without it the destructor closes in silence
///     std::vector<double> r = Hdf5File::open("a.h5").read<double>("/samples/cloth", {any_size, any_size, 3}).value;
class Hdf5File {
  public:
    static Hdf5File open(const std::string& path);    ///< to read
    static Hdf5File edit(const std::string& path);    ///< to read and to add or remove datasets
    static Hdf5File create(const std::string& path);  ///< replaces what is there; see NewFile for whole-or-nothing
    ~Hdf5File();
    Hdf5File(Hdf5File&&) noexcept;
    Hdf5File& operator=(Hdf5File&&) noexcept;

    const std::string& path() const;
    void close();  ///< writes everything out and syncs; Error if any byte did not reach the disk

    bool has(const std::string& name) const;                           ///< a dataset or group of this name
    std::vector<std::string> members(const std::string& group) const;  ///< sorted; empty where there is no such group
    bool is_dataset(const std::string& name) const;
    Shape shape(const std::string& dataset) const;
    std::string type_name(const std::string& dataset) const;  ///< "float32", "int8", "uint8", "string", ... or "other"

    template <typename T>
    Array<T> read(const std::string& dataset) const;
    /// Error unless the shape is as expected.
    template <typename T>
    Array<T> read(const std::string& dataset, const Shape& expected) const;
    /// Rows [first, first + count) along the first dimension.
    template <typename T>
    Array<T> read_rows(const std::string& dataset, int64_t first, int64_t count) const;
    std::vector<std::string> read_strings(const std::string& dataset) const;
    /// Where the rows of a virtual dataset lie, in order; empty for any other dataset. Those that others wrote, and
    /// which are not rows of other files one after the other, are read by the library, and are empty here.
    std::vector<VirtualRows> virtual_rows(const std::string& dataset) const;
    /// One line for each file that a virtual dataset refers to and that cannot be opened.
    std::vector<std::string> unreadable_parts(const std::string& dataset) const;
    /// The gzip level of a dataset that is stored in chunks; -1 of one that is not.
    int deflate(const std::string& dataset) const;

    template <typename T>
    void write(const std::string& dataset, const T* value, const Shape& shape, const Storage& storage = {});
    template <typename T>
    void write(const std::string& dataset, const std::vector<T>& value, const Shape& shape,
               const Storage& storage = {}) {
        write(dataset, value.data(), shape, storage);
    }
    void write_strings(const std::string& dataset, const std::vector<std::string>& value);

    /// A dataset of `rows` rows that can grow; rows never written read as zero. `rows_per_chunk` 0: each row is a
    /// chunk, but rows of one value (an empty `row_shape`) share one.
    template <typename T>
    void create_rows(const std::string& dataset, int64_t rows, const Shape& row_shape, int deflate,
                     int64_t rows_per_chunk = 0);
    /// Writes one row, and extends the dataset to hold it.
    template <typename T>
    void write_row(const std::string& dataset, int64_t row, const T* value);
    /// Writes rows [first, first + count), and extends the dataset to hold them.
    template <typename T>
    void write_rows(const std::string& dataset, int64_t first, int64_t count, const T* value);
    /// A virtual dataset: the rows of others, one after the other, whatever the working directory of a reader. To read
    /// rows whose file is missing or damaged is an Error here; other programs get NaN, or 0 of integers.
    template <typename T>
    void create_virtual_rows(const std::string& dataset, const Shape& row_shape, const std::vector<VirtualRows>& part);
    /// Copies a row as it is stored, without unpacking it, to a dataset that `create_rows` made; unpacks it where the
    /// two are stored in different ways.
    template <typename T>
    void copy_row(const std::string& dataset, int64_t row, const Hdf5File& source, int64_t source_row);
    void remove(const std::string& name);
    /// Shows a dataset of another file under `name` (an external link). `file` is relative to this file's folder, and
    /// need not be there.
    void link(const std::string& name, const std::string& file, const std::string& dataset);

    // Attributes. `object` is a dataset or group; "/" is the root.
    bool has_attribute(const std::string& object, const std::string& key) const;
    std::vector<std::string> attributes(const std::string& object) const;  ///< their keys, sorted
    std::string string_attribute(const std::string& object, const std::string& key) const;
    std::vector<std::string> strings_attribute(const std::string& object, const std::string& key) const;
    int64_t integer_attribute(const std::string& object, const std::string& key) const;
    double number_attribute(const std::string& object, const std::string& key) const;
    std::vector<double> numbers_attribute(const std::string& object, const std::string& key) const;
    void set_attribute(const std::string& object, const std::string& key, const std::string& value);
    void set_attribute(const std::string& object, const std::string& key, const char* value);
    void set_attribute(const std::string& object, const std::string& key, const std::vector<std::string>& value);
    void set_attribute(const std::string& object, const std::string& key, int64_t value);
    void set_attribute(const std::string& object, const std::string& key, int value) {
        set_attribute(object, key, static_cast<int64_t>(value));
    }
    void set_attribute(const std::string& object, const std::string& key, double value);
    void set_attribute(const std::string& object, const std::string& key, const std::vector<double>& value);

  private:
    struct Impl;
    /// Rows of a virtual dataset from the files that hold them.
    template <typename T>
    Array<T> read_parts(const std::string& name, const VirtualDataset& whole, int64_t first, int64_t count) const;
    explicit Hdf5File(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files
