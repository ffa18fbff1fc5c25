#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "files/plan_file.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::files {
namespace {

class PlanFileTest : public ::testing::Test {
  protected:
    ~PlanFileTest() override { std::filesystem::remove(path_); }

    static CorpusPlan plan() {
        return {test::header_of(true, true), {7, 3, 1000000007}, {0, 2, 1}, {"mended", "both"}};
    }

    void expect_refused() const { EXPECT_THROW(read_plan(path_), Error); }

    const std::string path_ =
        (std::filesystem::temp_directory_path() / ("toile_plan_" + std::to_string(::getpid()) + ".h5")).string();
};

TEST_F(PlanFileTest, HoldsWhatAllShardsShare) {
    write_plan(path_, plan());
    const CorpusPlan again = read_plan(path_);
    EXPECT_EQ(again.pose_number, plan().pose_number);
    EXPECT_EQ(again.split, plan().split);
    EXPECT_EQ(again.remarks, plan().remarks);
    EXPECT_EQ(again.header.config_hash, plan().header.config_hash);
    EXPECT_EQ(again.header.mesh.rest_position, plan().header.mesh.rest_position);
    EXPECT_EQ(again.header.reasons, plan().header.reasons);
    EXPECT_EQ(again.header.gate, plan().header.gate);
    ASSERT_TRUE(again.header.image);
    EXPECT_EQ(again.header.image->size, plan().header.image->size);
}

TEST_F(PlanFileTest, NeedsNoImageAndNoRemarks) {
    CorpusPlan bare = plan();
    bare.header.image.reset();
    bare.remarks.clear();
    write_plan(path_, bare);
    EXPECT_FALSE(read_plan(path_).header.image);
    EXPECT_TRUE(read_plan(path_).remarks.empty());
}

TEST_F(PlanFileTest, IsRefusedWithoutItsNumbers) {
    write_plan(path_, plan());
    Hdf5File file = Hdf5File::edit(path_);
    file.remove("/plan/pose_number");
    file.close();
    expect_refused();
}

TEST_F(PlanFileTest, IsRefusedWithFewerSplits) {
    write_plan(path_, plan());
    Hdf5File file = Hdf5File::edit(path_);
    file.remove("/plan/split");
    file.write("/plan/split", std::vector<int>{0, 1}, {2});
    file.close();
    expect_refused();
}

TEST_F(PlanFileTest, IsRefusedWithASplitThatIsNone) {
    CorpusPlan wrong = plan();
    wrong.split[1] = 3;
    write_plan(path_, wrong);
    expect_refused();
}

TEST_F(PlanFileTest, IsRefusedWhereItIsTruncated) {
    write_plan(path_, plan());
    std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
    expect_refused();
}

}  // namespace
}  // namespace toile::files
