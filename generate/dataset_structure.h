#pragma once

#include <string>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::generate {

/// Every departure of a file from the contract's table of datasets, one line each: missing datasets, types, shapes,
/// sizes that do not agree, groups that are there in part, missing attributes. Reads no values.
std::vector<std::string> structure_defects(const files::Hdf5File& file);

}  // namespace toile::generate
