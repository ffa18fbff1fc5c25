#include "evaluate/displacement_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "files/binary_text.h"
#include "files/image_file.h"
#include "generate/drawing.h"

namespace toile::evaluate {
namespace {

constexpr int most_pixels = 512;  ///< of a layer, along a side

/// The image with the places of its numbers.
struct Channels {
    const std::vector<float>& value;
    int layers, height, width;

    float at(int layer, int component, int row, int column) const {
        return value[((static_cast<size_t>(3 * layer + component) * height) + row) * width + column];
    }
    bool holds_nothing(int layer, int row, int column) const {
        return at(layer, 0, row, column) == 0.0f && at(layer, 1, row, column) == 0.0f &&
               at(layer, 2, row, column) == 0.0f;
    }
    double largest(int component) const {
        double result = 0.0;
        const size_t area = static_cast<size_t>(height) * width;
        for (int layer = 0; layer < layers; ++layer)
            for (size_t k = 0; k < area; ++k) {
                const double size = std::abs(value[(3 * layer + component) * area + k]);
                if (std::isfinite(size)) result = std::max(result, size);
            }
        return result;
    }
};

files::Picture draw(const Channels& image, int component, double scale) {
    const int stride = (std::max(image.height, image.width) + most_pixels - 1) / most_pixels;
    const auto kept = [stride](int size) { return (size + stride - 1) / stride; };
    files::Picture picture{image.layers * kept(image.width), kept(image.height), 4, {}};
    for (int row = 0; row < image.height; row += stride)
        for (int layer = 0; layer < image.layers; ++layer)
            for (int column = 0; column < image.width; column += stride) {
                const double value = image.at(layer, component, row, column);
                const generate::Color color =
                    std::isfinite(value) ? generate::diverging(scale > 0.0 ? value / scale : 0.0) : generate::Color{};
                for (const double one : color)
                    picture.value.push_back(static_cast<std::uint8_t>(std::lround(255.0 * one)));
                picture.value.push_back(image.holds_nothing(layer, row, column) ? 0 : 255);
            }
    return picture;
}

}  // namespace

std::vector<DisplacementPicture> displacement_pictures(const std::vector<float>& image, int layers, int height,
                                                       int width) {
    constexpr std::array names{"Δu (along u)", "Δv (along v)", "Δn (outwards)"};
    const Channels channels{image, layers, height, width};
    std::vector<DisplacementPicture> pictures;
    for (int component = 0; component < 3; ++component) {
        const double scale = channels.largest(component);
        pictures.push_back(
            {fmt::format("{}, -{:.3g} to {:.3g} mm", names[component], 1e3 * scale, 1e3 * scale),
             "data:image/png;base64," + files::base64(files::png_bytes(draw(channels, component, scale)))});
    }
    return pictures;
}

}  // namespace toile::evaluate
