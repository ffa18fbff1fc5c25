#pragma once

#include <functional>
#include <string>

#include "files/hdf5_file.h"

namespace toile::files {

/// Whether the structures of an HDF5 file have checksums, as those that toile writes do. HDF5's first format, which
/// h5py writes unless it is told otherwise, has none. Internal to files/, as all here.
bool has_checksums(const std::string& path);

/// Reads whatever the file holds, of large datasets the first and the last row, in a child process: over damage that no
/// checksum shows HDF5 1.10 may crash. Throws Error where it does. `open` opens the file, and is called there.
void try_reading(const std::string& path, const std::function<Hdf5File()>& open);

}  // namespace toile::files
