#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "evaluate/displacement_picture.h"
#include "files/image_file.h"
#include "tests/evaluate/page_blob.h"

namespace toile::evaluate {
namespace {

/// What a browser would show.
files::Picture shown(const DisplacementPicture& picture) {
    const std::string begin = "data:image/png;base64,";
    EXPECT_EQ(picture.src.substr(0, begin.size()), begin);
    const std::vector<std::uint8_t> bytes = base64_bytes(picture.src.substr(begin.size()));
    const std::string path =
        (std::filesystem::temp_directory_path() / ("toile_displacement_" + std::to_string(getpid()) + ".png")).string();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    files::Picture read = files::read_png(path);
    std::filesystem::remove(path);
    return read;
}

std::vector<std::uint8_t> pixel(const files::Picture& picture, int row, int column) {
    const auto first = picture.value.begin() + (row * picture.width + column) * picture.channels;
    return {first, first + picture.channels};
}

TEST(DisplacementPicture, signs_are_colours_on_a_symmetric_scale) {
    // two layers of one row and two columns
    std::vector<float> image(2 * 3 * 2, 0.0f);
    image[0] = -0.012f;         // layer 0, Δu, column 0
    image[1] = 0.012f;          // layer 0, Δu, column 1
    image[3 * 2 + 4] = 0.004f;  // layer 1, Δn, column 0
    image[3 * 2 + 1] = NAN;     // layer 1, Δu, column 1
    const auto pictures = displacement_pictures(image, 2, 1, 2);
    ASSERT_EQ(pictures.size(), 3u);
    EXPECT_THAT(pictures[0].name, testing::HasSubstr("-12 to 12 mm"));
    EXPECT_THAT(pictures[1].name, testing::HasSubstr("-0 to 0 mm"));
    EXPECT_THAT(pictures[2].name, testing::HasSubstr("-4 to 4 mm"));
    const files::Picture du = shown(pictures[0]), dn = shown(pictures[2]);
    ASSERT_EQ(du.width, 4);
    ASSERT_EQ(du.height, 1);
    EXPECT_GT(pixel(du, 0, 0)[2], pixel(du, 0, 0)[0]) << "blue where negative";
    EXPECT_GT(pixel(du, 0, 1)[0], pixel(du, 0, 1)[2]) << "red where positive";
    const std::vector<std::uint8_t> grey = pixel(du, 0, 2);
    EXPECT_EQ(grey[0], grey[2]) << "grey at zero";
    EXPECT_EQ(pixel(du, 0, 3), (std::vector<std::uint8_t>{0, 0, 0, 255})) << "black where there is no number";
    EXPECT_EQ(pixel(dn, 0, 2), pixel(du, 0, 1)) << "each on its own scale";
}

TEST(DisplacementPicture, a_large_image_is_thinned_out) {
    constexpr int size = 1025;
    std::vector<float> image(3 * size * size, 0.001f);
    image[3 * size + 3] = -0.002f;  // row 3, column 3
    image[3 * size + 6] = 0.002f;
    const files::Picture du = shown(displacement_pictures(image, 1, size, size)[0]);
    ASSERT_EQ(du.width, 342) << "every third";
    ASSERT_EQ(du.height, 342);
    EXPECT_GT(pixel(du, 1, 1)[2], pixel(du, 1, 1)[0]) << "row 3, column 3";
    EXPECT_GT(pixel(du, 1, 2)[0], pixel(du, 1, 2)[2]) << "row 3, column 6";
}

TEST(DisplacementPicture, what_the_pattern_does_not_cover_is_clear) {
    std::vector<float> image{0, 1, 0, 0, 0, 0};  // one layer of one row and two columns: Δu, Δv, Δn
    const files::Picture dv = shown(displacement_pictures(image, 1, 1, 2)[1]);
    EXPECT_EQ(pixel(dv, 0, 0)[3], 0);
    EXPECT_EQ(pixel(dv, 0, 1)[3], 255);
}

}  // namespace
}  // namespace toile::evaluate
