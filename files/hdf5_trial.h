#pragma once

#include <functional>
#include <string>

#include "files/hdf5_file.h"

namespace toile::files {

/// Opens everything in an HDF5 file in a child process, with `open`, which is called there alone: over damage HDF5 1.10
/// may crash, or run on for ever. Throws Error where it does. Once for each file and process, until the file changes.
///
/// In a file that has checksums on its structures, as those that toile writes, that is all: values have their own. In
/// HDF5's first format, which h5py writes unless it is told otherwise and which has none, values are read too; of large
/// datasets the first and the last row. Internal to files/.
void try_reading(const std::string& path, const std::function<Hdf5File()>& open);

}  // namespace toile::files
