#pragma once

#include <array>
#include <string>

#include "files/image_file.h"

namespace toile::generate {

/// Red, green and blue in [0, 1].
using Color = std::array<double, 3>;
inline constexpr Color ink{0.15, 0.15, 0.17};

/// Cool to warm through grey, for values from -1 to 1 (after Moreland 2009).
Color diverging(double value);

/// A white picture of three channels.
files::Picture blank_picture(int width, int height);

/// Fills a rectangle of pixels from its upper left corner (x, y); what lies beyond the picture is left out.
void fill(files::Picture& picture, int x, int y, int width, int height, const Color& color);

/// ASCII text in ink, its upper left corner at (x, y), letters about 6 pixels wide and 12 high.
void write_text(files::Picture& picture, int x, int y, std::string text);

}  // namespace toile::generate
