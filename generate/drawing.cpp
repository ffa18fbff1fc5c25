#include "generate/drawing.h"

#include <cmath>
#include <cstdint>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace toile::generate {
namespace {

void set_pixel(files::Picture& picture, int x, int y, const Color& color) {
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
    for (int c = 0; c < 3; ++c)
        picture.value[(static_cast<size_t>(y) * picture.width + x) * 3 + c] =
            static_cast<uint8_t>(std::lround(255 * color[c]));
}

}  // namespace

Color diverging(double value) {
    const Color cool{0.23, 0.30, 0.75}, grey{0.87, 0.87, 0.87}, warm{0.71, 0.02, 0.15};
    const double share = std::min(std::abs(value), 1.0);
    Color color;
    for (int c = 0; c < 3; ++c) color[c] = grey[c] + share * ((value < 0 ? cool[c] : warm[c]) - grey[c]);
    return color;
}

files::Picture blank_picture(int width, int height) {
    files::Picture picture;
    picture.channels = 3;
    picture.width = width;
    picture.height = height;
    picture.value.assign(static_cast<size_t>(width) * height * 3, 255);
    return picture;
}

void fill(files::Picture& picture, int x, int y, int width, int height, const Color& color) {
    for (int j = y; j < y + height; ++j)
        for (int i = x; i < x + width; ++i) set_pixel(picture, i, j, color);
}

void write_text(files::Picture& picture, int x, int y, std::string text) {
    struct Corner {
        float x, y, z;
        unsigned char color[4];
    };
    std::vector<Corner> corner(text.size() * 80 + 4);
    const int quads = stb_easy_font_print(0, 0, text.data(), nullptr, corner.data(),
                                          static_cast<int>(corner.size() * sizeof(Corner)));
    for (int q = 0; q < quads; ++q) {
        const Corner &low = corner[4 * q], &high = corner[4 * q + 2];
        fill(picture, x + static_cast<int>(low.x), y + static_cast<int>(low.y), static_cast<int>(high.x - low.x),
             static_cast<int>(high.y - low.y), ink);
    }
}

}  // namespace toile::generate
