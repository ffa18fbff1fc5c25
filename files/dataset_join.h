#pragma once

#include <memory>
#include <string>

#include "files/dataset_file.h"

namespace toile::files {

/// Joins samples of other data set files into one, whole or not at all. One thread at a time; memory does not grow with
/// the number of samples.
///
/// - copy: the file that a `DatasetWriter` would have made of the same samples, to the last byte.
/// - refer: the samples' arrays are virtual datasets that lie in the parts (which must stay where they are, relative to
///   the new file), all else is in the file.
class DatasetJoin {
  public:
    enum class How { copy, refer };

    /// `deflate`: gzip level of the parts. Throws Error where the file cannot be made.
    DatasetJoin(const std::string& path, const DatasetHeader& header, int sample_count, int deflate, How how);
    ~DatasetJoin();  ///< without `finish`: leaves nothing behind
    DatasetJoin(const DatasetJoin&) = delete;
    DatasetJoin& operator=(const DatasetJoin&) = delete;

    /// Appends sample `row` of `part`. `columns` and `digest` are that sample's.
    void add(const DatasetReader& part, int row, const SampleRecord& columns, const Digest& digest);
    /// Error unless as many samples were added as there are to be.
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files
