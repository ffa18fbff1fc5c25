#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::generate {

/// One line of the contract's table. `size` lists numbers and letters; a letter stands for one size in the whole file.
struct Field {
    const char* name;
    const char* type;
    const char* size;
};

/// Datasets that are there together or not at all.
struct Feature {
    const char* name;
    bool required;
    std::vector<Field> field;
};

/// Adds a line to `defect` for every departure from the table: missing datasets, types, shapes, sizes that do not
/// agree. Reads no values. Returns the size each letter stands for.
std::map<std::string, int64_t> check_structure(const files::Hdf5File& file, const std::vector<Feature>& table,
                                               std::vector<std::string>& defect);

}  // namespace toile::generate
