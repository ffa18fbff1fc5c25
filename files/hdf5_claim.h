#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>

#include "files/hdf5_file.h"

namespace toile::files {

/// Product of the sizes. Throws Error where no computer could hold as many values. Internal to files/, as all here.
int64_t element_count(const Shape& shape);

/// Throws Error, without a place, where a dataset claims to hold more than its file can: damage or malice would have us
/// allocate it. gzip makes at most 1032 bytes of one, so a file may stand for about a thousand times its own size, and
/// a MB more for rows that were never written. Virtual datasets, whose bytes lie in other files, are let through, but
/// not one that draws on its own file, over which HDF5 1.10 runs out of stack; returns whether it is one.
///
/// Also refuses values kept in another file, and filters other than ours (shuffle, gzip, fletcher32) or one of them
/// twice: HDF5 1.10's others have overflows that are known.
bool check_claim(hid_t dataset, const std::string& path);

/// Throws Error for more values, of `width` bytes each, than are read from a virtual dataset at once.
void check_virtual_selection(int64_t count, size_t width);

/// The same for `count` values of an attribute, or texts of variable length, which are never compressed.
void check_stored_claim(hid_t object, int64_t count, size_t width);

}  // namespace toile::files
