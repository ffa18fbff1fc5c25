#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::files {

/// Writes a NumPy .npz file, an array after the other, none of them held in memory: an uncompressed zip of .npy files,
/// ZIP64 where an array or the file passes 4 GB. The bytes depend on the calls alone. The file appears whole or not at
/// all (see NewFile). Every failure to write is an Error with the system's reason.
///
///     NpzWriter file("a.npz");
///     file.begin("vertices_seq", "<f4", {samples, vertices, 3});
///     for (...) file.append(position.data(), position.size() * sizeof(float));
///     file.add("faces", triangle, {triangles, 3});
///     file.commit();
class NpzWriter {
  public:
    explicit NpzWriter(const std::string& path);
    ~NpzWriter();
    NpzWriter(const NpzWriter&) = delete;
    NpzWriter& operator=(const NpzWriter&) = delete;

    /// Starts an array, row-major. `type`: NumPy's name, "<f4", "<i8", "|S12".
    void begin(const std::string& name, const std::string& type, const Shape& shape);
    /// The next bytes of the array begun last.
    void append(const void* data, size_t bytes);

    /// A whole array: float, double, int8_t, int32_t or int64_t.
    template <typename T>
    void add(const std::string& name, const std::vector<T>& value, const Shape& shape);
    /// UTF-8 in bytes of one length, as in our HDF5 files.
    void add_strings(const std::string& name, const std::vector<std::string>& value);

    /// Throws Error too if an array got fewer bytes than its shape has.
    void commit();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files
