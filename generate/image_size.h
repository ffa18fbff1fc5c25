#pragma once

#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "generate/scene.h"
#include "pattern/pattern_image.h"

namespace toile::generate {

/// The scene's image options with the smallest size at which every accepted sample of `drapes` is read back within
/// `max_error`. Where even the largest size misses it, that size and a remark.
pattern::ImageOptions fitting_image(const DressedScene& dressed, const files::DatasetReader& drapes,
                                    std::vector<std::string>& remarks);

}  // namespace toile::generate
