#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "generate/output_folder.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        root_ = fs::temp_directory_path() / ("toile_output_" + std::to_string(getpid()) + "_" + info->name());
        fs::create_directories(root_);
    }
    void TearDown() override { fs::remove_all(root_); }
    fs::path root_;
};

TEST_F(OutputFolderTest, IsMadeAndKeptOnceItHoldsSomething) {
    const fs::path path = root_ / "a" / "b";
    {
        const OutputFolder folder(path.string());
        EXPECT_TRUE(fs::is_directory(path));
        std::ofstream(folder.file("dataset.h5")) << "data";
    }
    EXPECT_TRUE(fs::exists(path / "dataset.h5"));
}

TEST_F(OutputFolderTest, DisappearsAgainWhereTheWorkFailed) {
    { const OutputFolder folder((root_ / "a" / "b").string()); }
    EXPECT_FALSE(fs::exists(root_ / "a"));
    fs::create_directory(root_ / "old");
    { const OutputFolder folder((root_ / "old").string()); }
    EXPECT_TRUE(fs::exists(root_ / "old")) << "a folder that was there before stays";
}

TEST_F(OutputFolderTest, RefusesWhatIsInTheWay) {
    std::ofstream(root_ / "file") << "x";
    EXPECT_THROW(OutputFolder((root_ / "file").string()), Error);
    EXPECT_THROW(OutputFolder((root_ / "file" / "below").string()), Error);
    EXPECT_THROW(OutputFolder(""), Error);
    EXPECT_THROW(OutputFolder("/proc/toile"), Error);
    std::ofstream(root_ / "dataset.h5") << "x";
    EXPECT_THROW(OutputFolder(root_.string()), Error);
}

TEST_F(OutputFolderTest, ScratchFilesGo) {
    std::ofstream(root_ / "scratch") << "x";
    { const ScratchFile scratch((root_ / "scratch").string()); }
    EXPECT_FALSE(fs::exists(root_ / "scratch"));
}

}  // namespace
}  // namespace toile::generate
