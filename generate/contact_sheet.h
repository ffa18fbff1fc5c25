#pragma once

#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "files/image_file.h"

namespace toile::generate {

/// One row of a sheet.
struct SheetRow {
    std::string label;         ///< ASCII
    std::vector<float> image;  ///< `[3 layers x size x size]` displacement [m]
};

/// A picture to look at: one row a sample, and in it Δu, Δv and Δn over all panels, blue where negative, grey at zero,
/// red where positive, white away from the pattern. Each component has one scale for the whole sheet, in millimetres
/// above it.
files::Picture contact_sheet(const files::DatasetImage& image, const std::vector<SheetRow>& row);

}  // namespace toile::generate
