#pragma once

#include <hdf5.h>

namespace toile::files {

/// Makes `access_list` (a file access property list) write through a driver that survives a full disk.
///
/// HDF5 1.10 cannot close a file it failed to write to: H5Fclose fails, and the library crashes when the program ends.
/// This driver therefore never fails a write. It notes the first `errno` in `*write_error` and keeps what follows in
/// memory, so that the library can wind down in order; the caller looks at `*write_error` (0 = all is on the disk)
/// after every operation and after closing, and throws the file away. `write_error` must outlive the file. Closing
/// syncs the file to the disk.
void use_watched_driver(hid_t access_list, int* write_error);

}  // namespace toile::files
