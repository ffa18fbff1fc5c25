#include "files/image_file.h"

#include <png.h>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

png_uint_32 png_format(int channels, const std::string& where) {
    switch (channels) {
        case 1:
            return PNG_FORMAT_GRAY;
        case 3:
            return PNG_FORMAT_RGB;
        case 4:
            return PNG_FORMAT_RGBA;
        default:
            throw Error("a picture has 1, 3 or 4 channels, not " + std::to_string(channels), where);
    }
}

std::vector<uint8_t> encoded(const Picture& picture, const std::string& where) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.format = png_format(picture.channels, where);
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    const size_t expected = static_cast<size_t>(picture.width) * picture.height * picture.channels;
    if (picture.width < 1 || picture.height < 1 || picture.value.size() != expected)
        throw Error("a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                        " pixels has " + std::to_string(picture.value.size()) + " values",
                    where);
    png_alloc_size_t size = 0;
    if (!png_image_write_to_memory(&image, nullptr, &size, 0, picture.value.data(), 0, nullptr))
        throw Error(std::string("cannot encode the picture: ") + image.message, where);
    std::vector<uint8_t> bytes(size);
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.value.data(), 0, nullptr))
        throw Error(std::string("cannot encode the picture: ") + image.message, where);
    bytes.resize(size);
    return bytes;
}

}  // namespace

void write_png(const std::string& path, const Picture& picture) {
    const std::vector<uint8_t> bytes = encoded(picture, path);
    NewFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

std::vector<uint8_t> png_bytes(const Picture& picture) {
    return encoded(picture, {});
}

Picture read_png(const std::string& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&image, path.c_str()))
        throw Error(std::string("cannot read the picture: ") + image.message, path);
    Picture picture;
    picture.channels = !(image.format & PNG_FORMAT_FLAG_COLOR) ? 1 : (image.format & PNG_FORMAT_FLAG_ALPHA) ? 4 : 3;
    image.format = png_format(picture.channels, path);
    picture.width = static_cast<int>(image.width);
    picture.height = static_cast<int>(image.height);
    picture.value.resize(PNG_IMAGE_SIZE(image));
    if (!png_image_finish_read(&image, nullptr, picture.value.data(), 0, nullptr))
        throw Error(std::string("cannot read the picture: ") + image.message, path);
    return picture;
}

}  // namespace toile::files
