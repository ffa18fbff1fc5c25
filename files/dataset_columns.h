#pragma once

#include <memory>
#include <string>

#include "files/dataset_file.h"

namespace toile::files {

/// Calls `visit(name, T(), shape of a row)` for each array of the samples that a data set with this header has, in the
/// order they are written; T is the type they are stored in.
template <typename Visit>
void for_each_array(const DatasetHeader& header, const Visit& visit) {
    const int64_t vertices = header.mesh.vertex_count();
    visit("/samples/cloth", float(), Shape{vertices, 3});
    if (header.body) visit("/samples/pose", double(), Shape{static_cast<int64_t>(header.body->joint_name.size()), 3});
    if (header.embedding) {
        visit("/samples/embedded", float(), Shape{vertices, 3});
        visit("/samples/displacement", float(), Shape{vertices, 3});
        visit("/samples/frame", float(), Shape{vertices, 4});
    }
    if (header.image)
        visit("/samples/image", float(), Shape{3 * header.image->layers, header.image->size, header.image->size});
}

/// What a data set holds as a value or a few for each sample: id, split, status, digest, resampling error, certificate
/// and seconds, and the attributes that go with them. Written in blocks of rows, so that memory does not grow.
class DatasetColumns {
  public:
    /// Makes the datasets in `file`, which will be `path`. `seconds_inside`: in `file`, else in the file beside it.
    /// `file` and `header` must outlive this.
    DatasetColumns(Hdf5File& file, const std::string& path, const DatasetHeader& header, int64_t sample_count,
                   bool seconds_inside);
    ~DatasetColumns();

    /// Appends a sample. Its arrays are not looked at.
    void add(const SampleRecord& sample, const Digest& digest);
    int64_t count() const;  ///< samples added
    /// Writes the rest, attributes too. The file beside appears under its name with `commit`.
    void finish();
    void commit();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files
