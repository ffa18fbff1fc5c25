#pragma once

#include <optional>
#include <string>

#include "files/dataset_file.h"

namespace toile::files {

/// What all samples of a data set share: root attributes, /mesh, /body, /embedding and /image.
void write_dataset_header(Hdf5File& file, const DatasetHeader& header, int deflate);

/// The header of a file that `DatasetWriter` finished. Throws Error for what is missing or has another type or shape,
/// and for files that are not toile's or of another version.
DatasetHeader read_dataset_header(const Hdf5File& file);

/// The first thing in which two headers differ ("/mesh", "/image" ...), or nothing. The resampling error is not
/// compared.
std::string header_difference(const DatasetHeader& a, const DatasetHeader& b);

/// Where a part belongs, in root attributes of the names of its members; nothing where the file has none.
void write_part(Hdf5File& file, const CorpusPart& part);
std::optional<CorpusPart> read_part(const Hdf5File& file);

}  // namespace toile::files
