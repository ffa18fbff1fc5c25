#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include "cloth/error.h"
#include "files/hdf5_file.h"

namespace toile::files {
namespace {

using testing::HasSubstr;

/// whole.h5 shows rows 1 and 2 of s/a.h5, then rows 0 and 3 of s/b.h5; row r of a holds 10 r, 10 r + 1, of b 100 + ...
class Hdf5VirtualTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_virtual_" + std::string(info->name()) + std::to_string(getpid()));
        std::filesystem::create_directories(folder_ / "s");
        for (const char* name : {"s/a.h5", "s/b.h5"}) write_part(name, std::string(name) == "s/a.h5" ? 0.0f : 100.0f);
        write_whole(rows);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void write_part(const std::string& name, float first) const {
        Hdf5File file = Hdf5File::create(path(name));
        file.create_rows<float>("/x", 4, {2}, 4);
        for (int64_t row = 0; row < 4; ++row) {
            const float value[] = {first + 10.0f * static_cast<float>(row),
                                   first + 10.0f * static_cast<float>(row) + 1};
            file.write_row("/x", row, value);
        }
        file.close();
    }
    void write_whole(const std::vector<VirtualRows>& part) const {
        Hdf5File file = Hdf5File::create(path("whole.h5"));
        file.create_virtual_rows<float>("/samples/x", {2}, part);
        file.close();
    }
    std::string failure_of(const std::function<void()>& call) const {
        try {
            call();
        } catch (const Error& error) {
            return error.what() + std::string("|") + error.where() + "|" + error.mend();
        }
        return "no error";
    }

    const std::vector<VirtualRows> rows{{"s/a.h5", "/x", 1, 2}, {"s/b.h5", "/x", 0, 1}, {"s/b.h5", "/x", 3, 1}};
    const std::vector<float> values{10, 11, 20, 21, 100, 101, 130, 131};
    std::filesystem::path folder_;
};

TEST_F(Hdf5VirtualTest, ShowsRowsOfOthersAsItsOwn) {
    const Hdf5File file = Hdf5File::open(path("whole.h5"));
    EXPECT_EQ(file.shape("/samples/x"), (Shape{4, 2}));
    EXPECT_EQ(file.type_name("/samples/x"), "float32");
    EXPECT_EQ(file.read<float>("/samples/x").value, values);
    EXPECT_EQ(file.read<double>("/samples/x", {any_size, 2}).shape, (Shape{4, 2}));
    for (int64_t row = 3; row >= 0; --row)
        EXPECT_EQ(file.read_rows<float>("/samples/x", row, 1).value,
                  (std::vector<float>{values[2 * row], values[2 * row + 1]}));
    EXPECT_EQ(file.read_rows<float>("/samples/x", 1, 2).value, (std::vector<float>{20, 21, 100, 101}));
    EXPECT_TRUE(file.read_rows<float>("/samples/x", 2, 0).value.empty());
    EXPECT_THAT(failure_of([&] { file.read_rows<float>("/samples/x", 3, 2); }), HasSubstr("no rows 3 to 4"));
    EXPECT_THAT(failure_of([&] { file.read<int>("/samples/x"); }), HasSubstr("integers are expected"));
    const std::vector<VirtualRows> found = file.virtual_rows("/samples/x");
    ASSERT_EQ(found.size(), rows.size());
    for (size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(found[i].file, rows[i].file);
        EXPECT_EQ(found[i].dataset, "/x");
        EXPECT_EQ(found[i].first, rows[i].first);
        EXPECT_EQ(found[i].rows, rows[i].rows);
    }
    EXPECT_TRUE(Hdf5File::open(path("s/a.h5")).virtual_rows("/x").empty());
}

TEST_F(Hdf5VirtualTest, TheWorkingDirectoryDoesNotMatterNorWhereTheFolderLies) {
    const std::filesystem::path before = std::filesystem::current_path(), moved = folder_.string() + "_moved";
    std::filesystem::rename(folder_, moved);
    for (const std::filesystem::path& from : {std::filesystem::path("/"), moved, moved / "s"}) {
        std::filesystem::current_path(from);
        const Hdf5File file = Hdf5File::open(std::filesystem::relative(moved / "whole.h5").string());
        EXPECT_EQ(file.read<float>("/samples/x").value, values) << from;
    }
    std::filesystem::current_path(before);
    std::filesystem::rename(moved, folder_);
}

TEST_F(Hdf5VirtualTest, TheLibraryItselfReadsItFromAnywhere) {
    if (std::system("/usr/bin/python3 -c 'import h5py' 2> /dev/null") != 0) GTEST_SKIP() << "python3-h5py is not there";
    const std::string program = "import h5py\nx = h5py.File(\"" + path("whole.h5") +
                                "\")[\"samples/x\"]\nassert x.is_virtual and x.shape == (4, 2)\n"
                                "assert x[...].ravel().tolist() == [10, 11, 20, 21, 100, 101, 130, 131]\n";
    std::ofstream(path("read.py")) << program;
    EXPECT_EQ(std::system(("cd / && /usr/bin/python3 " + path("read.py")).c_str()), 0);
    EXPECT_EQ(std::system(("cd " + path("s") + " && /usr/bin/python3 " + path("read.py")).c_str()), 0);
}

TEST_F(Hdf5VirtualTest, APartThatIsMissingOrDamagedIsAnErrorNotFillValues) {
    std::filesystem::remove(path("s/b.h5"));
    {
        const Hdf5File file = Hdf5File::open(path("whole.h5"));
        EXPECT_EQ(file.read_rows<float>("/samples/x", 0, 2).value, (std::vector<float>{10, 11, 20, 21}));
        const std::string failure = failure_of([&] { file.read_rows<float>("/samples/x", 1, 2); });
        EXPECT_THAT(failure, HasSubstr("s/b.h5: the file does not exist"));
        EXPECT_THAT(failure, HasSubstr("whole.h5:/samples/x"));
        EXPECT_THAT(failure, HasSubstr("put it back"));
    }
    std::ofstream(path("s/b.h5")) << "not HDF5";
    EXPECT_THAT(failure_of([&] { Hdf5File::open(path("whole.h5")).read<float>("/samples/x"); }),
                HasSubstr("s/b.h5: not an HDF5 file"));
    Hdf5File shorter = Hdf5File::create(path("s/b.h5"));
    shorter.create_rows<float>("/x", 2, {2}, 4);
    shorter.close();
    EXPECT_THAT(failure_of([&] { Hdf5File::open(path("whole.h5")).read<float>("/samples/x"); }),
                HasSubstr("no rows 3 to 3"));
    Hdf5File wider = Hdf5File::create(path("s/b.h5"));
    wider.create_rows<float>("/x", 4, {3}, 4);
    wider.close();
    EXPECT_THAT(failure_of([&] { Hdf5File::open(path("whole.h5")).read<float>("/samples/x"); }),
                HasSubstr("rows of shape (1, 3)"));
}

TEST_F(Hdf5VirtualTest, VirtualDatasetsOfVirtualDatasetsAreRefused) {
    write_whole({{"whole.h5", "/samples/x", 0, 4}});  // of itself
    EXPECT_THAT(failure_of([&] { Hdf5File::open(path("whole.h5")).read<float>("/samples/x"); }),
                HasSubstr("refers to another virtual dataset"));
}

TEST_F(Hdf5VirtualTest, ManyPartsNeedFewOpenFiles) {
    std::vector<VirtualRows> many;
    for (int i = 0; i < 100; ++i) {
        const std::string name = "s/part_" + std::to_string(i) + ".h5";
        write_part(name, static_cast<float>(i));
        many.push_back({name, "/x", 0, 4});
    }
    write_whole(many);
    const auto open_files = [] {
        const std::filesystem::directory_iterator all("/proc/self/fd");
        return std::distance(begin(all), end(all));
    };
    const auto before = open_files();
    const Hdf5File file = Hdf5File::open(path("whole.h5"));
    for (int64_t row = 0; row < 400; row += 3)
        EXPECT_EQ(file.read_rows<float>("/samples/x", row, 1).value[0],
                  static_cast<float>(row / 4) + 10.0f * static_cast<float>(row % 4));
    EXPECT_LE(open_files(), before + 10);
}

TEST_F(Hdf5VirtualTest, NoRowsAreNoRows) {
    write_whole({});
    EXPECT_EQ(Hdf5File::open(path("whole.h5")).read<float>("/samples/x").shape, (Shape{0, 2}));
}

TEST_F(Hdf5VirtualTest, RowsAreCopiedAsTheyAreStored) {
    const Hdf5File source = Hdf5File::open(path("s/a.h5"));
    EXPECT_EQ(source.deflate("/x"), 4);
    for (const int deflate : {4, 1, 0}) {  // the same filters, another level, none
        Hdf5File copy = Hdf5File::create(path("copy.h5"));
        copy.create_rows<float>("/x", 4, {2}, deflate);
        for (int64_t row = 0; row < 4; ++row) copy.copy_row<float>("/x", row, source, 3 - row);
        EXPECT_THAT(failure_of([&] { copy.copy_row<float>("/x", 0, source, 4); }), HasSubstr("no row 4"));
        EXPECT_THAT(failure_of([&] { copy.copy_row<float>("/x", 4, source, 0); }), HasSubstr("no row 4"));
        copy.create_rows<float>("/y/x", 4, {3}, deflate);
        EXPECT_THAT(failure_of([&] { copy.copy_row<float>("/y/x", 0, source, 0); }), HasSubstr("no such dataset"));
        copy.close();
        const Hdf5File read = Hdf5File::open(path("copy.h5"));
        EXPECT_EQ(read.deflate("/x"), deflate);
        EXPECT_EQ(read.read<float>("/x").value, (std::vector<float>{30, 31, 20, 21, 10, 11, 0, 1}));
    }
}

}  // namespace
}  // namespace toile::files
