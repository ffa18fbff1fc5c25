#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace toile::evaluate {

/// A picture of one component of a displacement image.
struct DisplacementPicture {
    std::string name;  ///< "Δn (outwards), -12.3 to 12.3 mm"
    std::string src;   ///< a PNG as a data URI
};

/// One picture for each of Δu, Δv and Δn, the layers side by side: blue where negative, grey at zero, red where
/// positive, on a scale that is symmetric about zero; clear where the image holds nothing, black where it holds no
/// number. Of a layer of more than 512 pixels every second, third … is shown. `image`: `[3 layers x height x width]`,
/// channel 3·layer + component [m].
std::vector<DisplacementPicture> displacement_pictures(const std::vector<float>& image, int layers, int height,
                                                       int width);

}  // namespace toile::evaluate
