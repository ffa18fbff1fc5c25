#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/image_file.h"

namespace toile::files {
namespace {

std::filesystem::path scratch(const std::string& name) {
    return std::filesystem::temp_directory_path() / ("toile_" + std::to_string(getpid()) + name);
}

Picture gradient(int channels) {
    Picture picture{7, 5, channels, {}};
    for (int i = 0; i < 7 * 5 * channels; ++i) picture.value.push_back(static_cast<uint8_t>(i * 2));
    return picture;
}

TEST(ImageFile, ReadsBackWhatItWrote) {
    for (const int channels : {1, 3, 4}) {
        const std::string path = scratch("gradient.png").string();
        write_png(path, gradient(channels));
        const Picture again = read_png(path);
        EXPECT_EQ(again.width, 7);
        EXPECT_EQ(again.height, 5);
        EXPECT_EQ(again.channels, channels);
        EXPECT_EQ(again.value, gradient(channels).value);
        EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
        std::filesystem::remove(path);
    }
}

TEST(ImageFile, RefusesSizesThatDoNotFit) {
    const std::string path = scratch("bad.png").string();
    Picture picture = gradient(3);
    picture.value.pop_back();
    EXPECT_THROW(write_png(path, picture), Error);
    picture = gradient(3);
    picture.channels = 2;
    EXPECT_THROW(write_png(path, picture), Error);
    EXPECT_THROW(write_png(path, Picture{}), Error);
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
}

TEST(ImageFile, RefusesAFolderThatIsNotThere) {
    EXPECT_THROW(write_png("/nowhere/at/all.png", gradient(3)), Error);
    EXPECT_THROW(read_png("/nowhere/at/all.png"), Error);
}

TEST(ImageFile, RefusesDamagedFiles) {
    const std::string path = scratch("damaged.png").string();
    std::ofstream(path) << "\x89PNG\r\n\x1a\n and then nothing of the sort";
    EXPECT_THROW(read_png(path), Error);
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace toile::files
