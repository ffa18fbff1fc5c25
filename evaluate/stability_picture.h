#pragma once

#include <string>
#include <vector>

#include "evaluate/stability.h"
#include "files/image_file.h"

namespace toile::evaluate {

/// The suite as a grid: a row for what is varied, a block of columns for each scene, in it one for each solver. A
/// cell's colour says whether the case passed, rests but with energy that rose, does not rest, or is not finite; in it
/// stands the time [s].
files::Picture stability_picture(const std::vector<StabilityOutcome>& outcomes, const std::vector<std::string>& solver);

}  // namespace toile::evaluate
