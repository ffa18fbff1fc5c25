#pragma once

#include <string>

#include "files/hdf5_file.h"

namespace toile::files {

/// The numbers of a dataset, whatever they are stored as: files that others wrote hold lengths as integers or in single
/// precision. Error unless the shape is as expected, and for anything but numbers.
Array<double> read_numbers(const Hdf5File& file, const std::string& dataset, const Shape& expected);

/// The same for rows [first, first + count).
Array<double> read_number_rows(const Hdf5File& file, const std::string& dataset, int64_t first, int64_t count);

}  // namespace toile::files
