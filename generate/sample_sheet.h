#pragma once

#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "files/image_file.h"

namespace toile::generate {

/// One picture of a sheet.
struct SheetTile {
    int slot = 0;
    std::string label;  ///< ASCII, lines parted by \n
};

/// Body and cloth of some samples from the front, all to one scale, four in a row. The cloth's colour is its stretch:
/// the mean of length over rest length of the edges at a vertex, red at 1.25, white at 1, blue at 0.75. Samples whose
/// cloth is not finite are left out.
files::Picture sample_sheet(const files::DatasetReader& reader, const std::vector<SheetTile>& tile);

}  // namespace toile::generate
