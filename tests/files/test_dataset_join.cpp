#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/dataset_join.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::files {
namespace {

using test::expect_same;
using test::header_of;
using test::sample_of;

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Seven samples of two parts, and the same in one file.
class DatasetJoinTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_join_" + std::string(info->name()) + std::to_string(getpid()));
        for (const char* name : {"single", "shard"}) std::filesystem::create_directories(folder_ / name);
        write("single/dataset.h5", 0, 7, std::nullopt);
        write("shard/part_00000.h5", 0, 3, CorpusPart{0, 1, 0, 7});
        write("shard/part_00001.h5", 3, 4, CorpusPart{0, 1, 3, 7});
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void write(const std::string& name, int first, int count, const std::optional<CorpusPart>& part) const {
        DatasetWriter writer(path(name), header, count, 4, part);
        for (int row = 0; row < count; ++row) writer.write(row, sample_of(header, first + row));
        writer.finish();
    }
    /// `slots` of the seven.
    void join(DatasetJoin::How how, const std::vector<int>& slots) const {
        const DatasetReader first(path("shard/part_00000.h5")), second(path("shard/part_00001.h5"));
        DatasetJoin joined(path("dataset.h5"), header, static_cast<int>(slots.size()), 4, how);
        for (const int slot : slots) {
            const DatasetReader& part = slot < 3 ? first : second;
            const int row = slot < 3 ? slot : slot - 3;
            joined.add(part, row, part.read_columns(row, 1).front(), part.stored_digest(row));
        }
        joined.finish();
    }

    const DatasetHeader header = header_of(true, true);
    std::filesystem::path folder_;
};

TEST_F(DatasetJoinTest, ACopyIsTheFileOfASingleRunToTheLastByte) {
    join(DatasetJoin::How::copy, {0, 1, 2, 3, 4, 5, 6});
    EXPECT_TRUE(bytes_of(path("dataset.h5")) == bytes_of(path("single/dataset.h5")));
    EXPECT_TRUE(bytes_of(path("dataset.timing.h5")) == bytes_of(path("single/dataset.timing.h5")));
}

TEST_F(DatasetJoinTest, WhatIsReferredToReadsAsIfItWereThere) {
    join(DatasetJoin::How::refer, {0, 1, 2, 3, 4, 5, 6});
    const DatasetReader joined(path("dataset.h5")), single(path("single/dataset.h5"));
    ASSERT_EQ(joined.sample_count(), 7);
    EXPECT_FALSE(joined.part());
    EXPECT_EQ(joined.header().resampling_error, single.header().resampling_error);
    EXPECT_EQ(joined.header().gate, single.header().gate);
    for (int slot = 0; slot < 7; ++slot) {
        expect_same(joined.read(slot), single.read(slot));
        EXPECT_EQ(joined.stored_digest(slot), single.stored_digest(slot));
    }
    const std::vector<VirtualRows> rows = joined.file().virtual_rows("/samples/image");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1].file, "shard/part_00001.h5");
    EXPECT_EQ(rows[1].rows, 4);
    const std::string before = bytes_of(path("dataset.h5"));
    join(DatasetJoin::How::refer, {0, 1, 2, 3, 4, 5, 6});
    EXPECT_TRUE(bytes_of(path("dataset.h5")) == before);
}

TEST_F(DatasetJoinTest, SamplesMayBeLeftOut) {
    for (const DatasetJoin::How how : {DatasetJoin::How::copy, DatasetJoin::How::refer}) {
        join(how, {0, 2, 4, 5});
        const DatasetReader joined(path("dataset.h5"));
        ASSERT_EQ(joined.sample_count(), 4);
        const int slot_of[] = {0, 2, 4, 5};
        for (int row = 0; row < 4; ++row) expect_same(joined.read(row), sample_of(header, slot_of[row]));
    }
    join(DatasetJoin::How::refer, {});
    EXPECT_EQ(DatasetReader(path("dataset.h5")).sample_count(), 0);
}

TEST_F(DatasetJoinTest, WholeOrNotAtAll) {
    const DatasetReader part(path("shard/part_00000.h5"));
    std::ofstream(path("dataset.h5")) << "what was here before";
    {
        DatasetJoin joined(path("dataset.h5"), header, 2, 4, DatasetJoin::How::copy);
        joined.add(part, 0, part.read_columns(0, 1).front(), part.stored_digest(0));
        EXPECT_THROW(joined.finish(), Error);
        joined.add(part, 1, part.read_columns(1, 1).front(), part.stored_digest(1));
        EXPECT_THROW(joined.add(part, 2, part.read_columns(2, 1).front(), part.stored_digest(2)), Error);
    }
    EXPECT_EQ(bytes_of(path("dataset.h5")), "what was here before");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 3) << "dataset.h5, single and shard";
}

}  // namespace
}  // namespace toile::files
