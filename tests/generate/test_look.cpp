#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <set>

#include "cloth/error.h"
#include "files/image_file.h"
#include "files/mesh_file.h"
#include "generate/contact_sheet.h"
#include "generate/look.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::generate {
namespace {

class LookTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_look_" + std::string(info->name()) + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

TEST_F(LookTest, WritesAMeshOfBodyAndClothForEachSampleAndOneSheet) {
    const std::string dataset = (folder_ / "dataset.h5").string();
    TinyDataset().write(dataset);
    const auto written = write_look(dataset, folder_.string(), {0, 2, 9, -1});
    ASSERT_EQ(written.size(), 3u);
    EXPECT_THAT(written[0], testing::EndsWith("pose_0010.glb"));
    EXPECT_THAT(written[1], testing::EndsWith("pose_0012.glb"));
    EXPECT_THAT(written[2], testing::EndsWith("displacements.png"));
    const files::MeshData scene = files::read_mesh(written[1]);
    const files::DatasetReader reader(dataset);
    EXPECT_EQ(scene.triangle.rows(), reader.header().body->triangle.rows() + reader.header().mesh.triangle.rows());
    // The cloth is where the dataset has it: the largest height of the scene is its own.
    EXPECT_NEAR(scene.position.col(2).maxCoeff(), reader.read(2).cloth.col(2).maxCoeff(), 1e-6);
    EXPECT_GT(files::read_png(written[2]).width, 300);
}

TEST_F(LookTest, SamplesThatAreNotFiniteArePassedOver) {
    const std::string dataset = (folder_ / "dataset.h5").string();
    TinyDataset tiny;
    tiny.change_sample = [](int slot, files::SampleRecord& sample) {
        if (slot != 1) return;
        sample.status = 1;
        sample.cloth(0, 0) = std::numeric_limits<double>::quiet_NaN();
    };
    tiny.write(dataset);
    EXPECT_TRUE(write_look(dataset, folder_.string(), {1}).empty());
}

/// Two layers of 8 x 8 pixels, covered in the middle.
files::DatasetImage small_image() {
    files::DatasetImage image{8, 2, Positions::Zero(1, 3), std::vector<uint8_t>(128, 0)};
    for (int layer = 0; layer < 2; ++layer)
        for (int row = 2; row < 6; ++row)
            for (int column = 1; column < 7; ++column) image.mask[(layer * 8 + row) * 8 + column] = 1;
    return image;
}

TEST(ContactSheet, NegativeIsBlueAndPositiveIsRed) {
    std::vector<float> image(6 * 64, 0.0f);
    for (int i = 0; i < 64; ++i) {
        image[i] = -0.01f;          // du of layer 0
        image[2 * 64 + i] = 0.01f;  // dn of layer 0
    }
    const files::Picture picture = contact_sheet(small_image(), {{"pose 1", image}});
    int blue = 0, red = 0, grey = 0;
    for (size_t i = 0; i < picture.value.size(); i += 3) {
        const int r = picture.value[i], b = picture.value[i + 2], g = picture.value[i + 1];
        blue += r == 59 && g == 77 && b == 191;
        red += r == 181 && g == 5 && b == 38;
        grey += r == 222 && g == 222 && b == 222;
    }
    const int tile = 24 * 20 * 20;  // covered pixels, enlarged 20 times
    EXPECT_GE(blue, tile);
    EXPECT_LT(blue, tile + 200);  // the colour bars
    EXPECT_GE(red, tile);
    EXPECT_GE(grey, 4 * tile);  // dv, and all of layer 1
}

TEST(ContactSheet, WhatIsNotFiniteIsBlack) {
    const std::vector<float> image(6 * 64, std::numeric_limits<float>::quiet_NaN());
    const files::Picture picture = contact_sheet(small_image(), {{"pose 1", image}});
    int black = 0;
    for (size_t i = 0; i < picture.value.size(); i += 3)
        black += picture.value[i] == 0 && picture.value[i + 1] == 0 && picture.value[i + 2] == 0;
    EXPECT_EQ(black, 6 * 24 * 20 * 20);
}

}  // namespace
}  // namespace toile::generate
