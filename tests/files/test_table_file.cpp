#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "files/table_file.h"

namespace toile::files {
namespace {

class TableFile : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(path_); }

    Table read(const std::string& text) {
        std::ofstream(path_, std::ios::binary) << text;
        return read_table(path_);
    }
    std::string error_of_file() {
        try {
            read_table(path_);
        } catch (const Error& e) {
            EXPECT_EQ(e.where().rfind(path_, 0), 0u) << e.where();
            return e.what() + (" (" + e.where().substr(std::min(path_.size(), e.where().size())) + ")");
        }
        return {};
    }
    std::string error(const std::string& text) {
        std::ofstream(path_, std::ios::binary) << text;
        return error_of_file();
    }

    std::string path_ =
        testing::TempDir() + "toile_table_" + testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(TableFile, ReadsCsv) {
    const Table table =
        read("\xEF\xBB\xBF# posed by hand\n\nchest.x, \"upper.01.L.y\" ,spine.raise\r\n1,-2.5e-1,+3\r\n\n.5,0,7\n");
    EXPECT_EQ(table.column, (std::vector<std::string>{"chest.x", "upper.01.L.y", "spine.raise"}));
    Eigen::MatrixXd expected(2, 3);
    expected << 1, -0.25, 3, 0.5, 0, 7;
    EXPECT_EQ(table.value, expected);
    EXPECT_EQ(table.where(1), path_ + ":6");
    EXPECT_EQ(table.where_columns(), path_ + ":3");
}

TEST_F(TableFile, RefusesOneDefectInCsvAtATime) {
    ASSERT_EQ(error("a,b\n1,2\n"), "");
    EXPECT_THAT(error(""), testing::HasSubstr("empty"));
    EXPECT_THAT(error("\n# nothing\n"), testing::HasSubstr("empty"));
    EXPECT_THAT(error("a,b\n"), testing::HasSubstr("no row"));
    EXPECT_THAT(error("a,b\n1,2\n1\n"), testing::HasSubstr("has 1 values, but there are 2 columns (:3)"));
    EXPECT_THAT(error("a,b\n1,2,3\n"), testing::HasSubstr("has 3 values"));
    EXPECT_THAT(error("a,b\n1,two\n"), testing::HasSubstr("'b' should be a number, but is 'two' (:2)"));
    EXPECT_THAT(error("a,b\n1,\n"), testing::HasSubstr("but is '' (:2)"));
    EXPECT_THAT(error("a,b\n1,nan\n"), testing::HasSubstr("but is 'nan' (:2)"));
    EXPECT_THAT(error("a,b\n1,inf\n"), testing::HasSubstr("but is 'inf' (:2)"));
    EXPECT_THAT(error("a,b\n1,1e999\n"), testing::HasSubstr("(:2)"));
    EXPECT_THAT(error("a,b\n1,2 3\n"), testing::HasSubstr("'2 3'"));
    EXPECT_THAT(error("a,a\n1,2\n"), testing::HasSubstr("two columns are named 'a' (:1)"));
    EXPECT_THAT(error("a,\n1,2\n"), testing::HasSubstr("column 2 has no name (:1)"));
    EXPECT_THAT(error(std::string("\x7f"
                                  "ELF\2\1\1\0\0\0\n\1\2",
                                  13)),
                testing::HasSubstr("neither"));
    EXPECT_THROW(read_table("/nowhere/poses.csv"), Error);
    EXPECT_THROW(read_table(testing::TempDir()), Error);
}

TEST_F(TableFile, ReadsADataset) {
    {
        Hdf5File file = Hdf5File::create(path_);
        file.write("/samples/pose", std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {2, 2, 3});
        file.close();
    }
    EXPECT_TRUE(read_table(path_).column.empty());
    std::vector<double> bind(32, 0.0);
    bind[3] = 0.25;
    bind[16] = 1;
    {
        Hdf5File file = Hdf5File::edit(path_);
        file.write_strings("/body/joint_name", {"hips", "arm.L"});
        file.write("/body/joint_bind", bind, {2, 4, 4});
        file.close();
    }
    const Table table = read_table(path_);
    EXPECT_EQ(table.column, (std::vector<std::string>{"hips.x", "hips.y", "hips.z", "arm.L.x", "arm.L.y", "arm.L.z"}));
    EXPECT_EQ(table.value(1, 4), 11);
    EXPECT_EQ(table.where(1), path_ + ":/samples/pose[1]");
    ASSERT_EQ(table.joint_bind.size(), 2u);
    EXPECT_EQ(table.joint_bind[0](0, 3), 0.25);
    EXPECT_EQ(table.joint_bind[1](0, 0), 1);
}

TEST_F(TableFile, ReadsPosesWithNamedColumns) {
    Hdf5File file = Hdf5File::create(path_);
    file.write("/pose", std::vector<float>{0.5f, 1, 2, 3}, {2, 2});
    file.set_attribute("/pose", "columns", std::vector<std::string>{"spine.raise", "chest.x"});
    file.close();
    const Table table = read_table(path_);
    EXPECT_EQ(table.column, (std::vector<std::string>{"spine.raise", "chest.x"}));
    EXPECT_EQ(table.value(0, 0), 0.5);
}

TEST_F(TableFile, RefusesOneDefectInHdf5AtATime) {
    const auto with = [&](const std::string& name, std::vector<double> value, const Shape& shape,
                          const std::vector<std::string>& joints, const std::vector<std::string>& columns) {
        Hdf5File file = Hdf5File::create(path_);
        file.write(name, value, shape);
        if (!joints.empty()) file.write_strings("/body/joint_name", joints);
        if (!columns.empty()) file.set_attribute(name, "columns", columns);
        file.close();
        return error_of_file();
    };
    ASSERT_EQ(with("/samples/pose", {1, 2, 3}, {1, 1, 3}, {"a"}, {}), "");
    EXPECT_THAT(with("/samples/pose", {1, 2, 3}, {1, 1, 3}, {"a", "b"}, {}), testing::HasSubstr("2 are named"));
    EXPECT_THAT(with("/samples/pose", {1, 2, 3, 4}, {1, 1, 4}, {}, {}), testing::HasSubstr("/samples/pose"));
    EXPECT_THAT(with("/samples/pose", {1, std::numeric_limits<double>::quiet_NaN(), 3}, {1, 1, 3}, {}, {}),
                testing::HasSubstr("(:/samples/pose[0])"));
    EXPECT_THAT(with("/samples/pose", {}, {0, 1, 3}, {}, {}), testing::HasSubstr("no row"));
    EXPECT_NE(with("/pose", {1, 2}, {1, 2}, {}, {}), "");
    EXPECT_THAT(with("/pose", {1, 2}, {1, 2}, {}, {"a"}), testing::HasSubstr("1 columns are named"));
    EXPECT_THAT(with("/pose", {1, 2}, {1, 2}, {}, {"a", "a"}), testing::HasSubstr("two columns"));
    EXPECT_THAT(with("/other", {1, 2}, {1, 2}, {}, {}), testing::HasSubstr("no poses"));
}

TEST_F(TableFile, RefusesATruncatedHdf5) {
    {
        Hdf5File file = Hdf5File::create(path_);
        file.write("/samples/pose", std::vector<double>(3000, 0.5), {1000, 1, 3});
        file.close();
    }
    ASSERT_EQ(error_of_file(), "");
    const auto size = std::filesystem::file_size(path_);
    for (const double share : {0.9, 0.5, 0.1}) {
        std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
        EXPECT_NE(error_of_file(), "") << share;
    }
}

}  // namespace
}  // namespace toile::files
