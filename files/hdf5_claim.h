#pragma once

#include <hdf5.h>

#include <cstdint>

#include "files/hdf5_file.h"

namespace toile::files {

/// Product of the sizes. Throws Error where no computer could hold as many values. Internal to files/, as all here.
int64_t element_count(const Shape& shape);

/// Throws Error, without a place, where a dataset claims to hold more than its file can: damage or malice would have us
/// allocate it. gzip makes at most 1032 bytes of one, so a file may stand for about a thousand times its own size, and
/// a MB more for rows that were never written. Of a virtual dataset, whose bytes lie in other files, `selected` (the
/// values about to be read, `width` bytes each) is bounded instead.
///
/// Also refuses values kept in another file, and filters other than ours (shuffle, gzip, fletcher32) or one of them
/// twice: HDF5 1.10's others have overflows that are known.
void check_claim(hid_t dataset, int64_t selected, size_t width);

/// The same for `count` values of an attribute, or texts of variable length, which are never compressed.
void check_stored_claim(hid_t object, int64_t count, size_t width);

}  // namespace toile::files
