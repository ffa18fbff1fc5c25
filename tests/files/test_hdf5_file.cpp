#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "tests/support/file_size_limit.h"

namespace toile::files {
namespace {

using test::FileSizeLimit;
using testing::HasSubstr;

class Hdf5FileTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("toile_hdf5_" + std::string(info->name()) + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name = "a.h5") const { return (folder_ / name).string(); }

    /// A file with one dataset of each sort.
    std::string valid(const std::string& name = "a.h5") const {
        Hdf5File file = Hdf5File::create(path(name));
        file.write("/samples/cloth", std::vector<float>{1, 2, 3, 4, 5, 6}, {2, 3}, {4, {1, 3}});
        file.write("/samples/id", std::vector<int64_t>{7, 8}, {2});
        file.write("/mesh/mass", std::vector<double>{0.25, 0.5}, {2}, {0, {}});
        file.write_strings("/body/joint_name", {"hip", "épaule", ""});
        file.set_attribute("/", "format", "toile");
        file.set_attribute("/samples/cloth", "error", std::vector<double>{0.5, 0.125});
        file.close();
        return path(name);
    }

    std::filesystem::path folder_;
};

Error error_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no error";
    return Error("none");
}

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(Hdf5FileTest, ReadsBackWhatItWrote) {
    const Hdf5File file = Hdf5File::open(valid());
    EXPECT_EQ(file.read<float>("/samples/cloth").value, (std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(file.read<double>("/samples/cloth", {any_size, 3}).shape, (Shape{2, 3}));
    EXPECT_EQ(file.read_rows<float>("/samples/cloth", 1, 1).value, (std::vector<float>{4, 5, 6}));
    EXPECT_EQ(file.read<int32_t>("/samples/id").value, (std::vector<int32_t>{7, 8}));
    EXPECT_EQ(file.read<double>("/mesh/mass").value, (std::vector<double>{0.25, 0.5}));
    EXPECT_EQ(file.read_strings("/body/joint_name"), (std::vector<std::string>{"hip", "épaule", ""}));
    EXPECT_EQ(file.string_attribute("/", "format"), "toile");
    EXPECT_EQ(file.numbers_attribute("/samples/cloth", "error"), (std::vector<double>{0.5, 0.125}));
    EXPECT_EQ(file.members("/samples"), (std::vector<std::string>{"cloth", "id"}));
    EXPECT_EQ(file.type_name("/samples/cloth"), "float32");
    EXPECT_EQ(file.type_name("/body/joint_name"), "string");
    EXPECT_TRUE(file.has("/samples/cloth"));
    EXPECT_FALSE(file.has("/samples/image"));
    EXPECT_FALSE(file.has("/nothing/at/all"));
}

TEST_F(Hdf5FileTest, AttributesOfEachSort) {
    Hdf5File file = Hdf5File::create(path());
    file.set_attribute("/", "version", 3);
    file.set_attribute("/", "seed", int64_t{1} << 60);
    file.set_attribute("/", "limit", 0.5);
    file.set_attribute("/", "reasons", std::vector<std::string>{"accepted", "not at rest"});
    file.set_attribute("/", "config", std::string(200000, 'x'));
    file.set_attribute("/", "version", 4);  // replaces
    EXPECT_EQ(file.integer_attribute("/", "version"), 4);
    EXPECT_EQ(file.integer_attribute("/", "seed"), int64_t{1} << 60);
    EXPECT_EQ(file.number_attribute("/", "limit"), 0.5);
    EXPECT_EQ(file.strings_attribute("/", "reasons"), (std::vector<std::string>{"accepted", "not at rest"}));
    EXPECT_EQ(file.string_attribute("/", "config").size(), 200000u);
    EXPECT_EQ(file.attributes("/"), (std::vector<std::string>{"config", "limit", "reasons", "seed", "version"}));
    EXPECT_THAT(error_of([&] { file.integer_attribute("/", "limit"); }).what(), HasSubstr("one integer"));
    EXPECT_THAT(error_of([&] { file.string_attribute("/", "nothing"); }).what(), HasSubstr("no attribute \"nothing\""));
}

TEST_F(Hdf5FileTest, RowsGrowAndUnwrittenRowsAreZero) {
    Hdf5File file = Hdf5File::create(path());
    file.create_rows<float>("/samples/image", 2, {2, 2}, 4);
    const std::vector<float> row{1, 2, 3, 4};
    file.write_row("/samples/image", 1, row.data());
    file.write_row("/samples/image", 3, row.data());
    file.close();
    const Hdf5File again = Hdf5File::open(path());
    EXPECT_EQ(again.shape("/samples/image"), (Shape{4, 2, 2}));
    EXPECT_EQ(again.read_rows<float>("/samples/image", 3, 1).value, row);
    EXPECT_EQ(again.read_rows<float>("/samples/image", 0, 1).value, std::vector<float>(4, 0.0f));
    EXPECT_THAT(error_of([&] { again.read_rows<float>("/samples/image", 3, 2); }).what(), HasSubstr("no rows 3 to 4"));
}

TEST_F(Hdf5FileTest, ManyRowsAreWrittenAtOnce) {
    Hdf5File file = Hdf5File::create(path());
    file.create_rows<double>("/samples/position", 3, {2}, 0);
    file.create_rows<int>("/samples/count", 3, {}, 0);
    file.write_rows("/samples/position", 1, 2, std::vector<double>{1, 2, 3, 4}.data());
    file.write_rows("/samples/count", 2, 3, std::vector<int>{7, 8, 9}.data());
    file.write_rows("/samples/count", 0, 0, static_cast<const int*>(nullptr));
    EXPECT_THAT(error_of([&] { file.write_rows("/samples/count", -1, 1, std::vector<int>{1}.data()); }).what(),
                HasSubstr("no row -1"));
    file.close();
    const Hdf5File again = Hdf5File::open(path());
    EXPECT_EQ(again.read<double>("/samples/position").value, (std::vector<double>{0, 0, 1, 2, 3, 4}));
    EXPECT_EQ(again.read<int>("/samples/count").value, (std::vector<int>{0, 0, 7, 8, 9}));
}

TEST_F(Hdf5FileTest, EmptyDatasetsAndSingleValues) {
    Hdf5File file = Hdf5File::create(path());
    file.write("/a/empty", std::vector<float>{}, {0, 3}, {4, {}});
    file.write("/a/single", std::vector<double>{2.5}, {});
    file.write_strings("/a/names", {});
    file.close();
    const Hdf5File again = Hdf5File::open(path());
    EXPECT_EQ(again.read<float>("/a/empty").shape, (Shape{0, 3}));
    EXPECT_EQ(again.read<double>("/a/single").value, std::vector<double>{2.5});
    EXPECT_TRUE(again.read_strings("/a/names").empty());
}

TEST_F(Hdf5FileTest, SameCallsGiveSameBytes) {
    const auto linked = [&](const std::string& name) {
        Hdf5File file = Hdf5File::create(path(name));
        file.link("/group/of/a/link", "other.h5", "/x");
        file.close();
        return bytes_of(path(name));
    };
    const std::string first = bytes_of(valid("first.h5")), first_linked = linked("first_linked.h5");
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a timestamp would have moved on
    EXPECT_EQ(first, bytes_of(valid("again.h5")));
    EXPECT_TRUE(first_linked == linked("again_linked.h5"));
}

TEST_F(Hdf5FileTest, RefusesWrongTypesAndShapes) {
    const Hdf5File file = Hdf5File::open(valid());
    EXPECT_THAT(error_of([&] { file.read<int32_t>("/samples/cloth"); }).what(), HasSubstr("integers are expected"));
    EXPECT_THAT(error_of([&] { file.read<double>("/samples/id"); }).what(), HasSubstr("holds int64"));
    EXPECT_THAT(error_of([&] { file.read<double>("/body/joint_name"); }).what(), HasSubstr("holds string"));
    EXPECT_THAT(error_of([&] { file.read_strings("/samples/id"); }).what(), HasSubstr("strings are expected"));
    const Error shape = error_of([&] { file.read<float>("/samples/cloth", {any_size, 4}); });
    EXPECT_THAT(shape.what(), HasSubstr("(2, 3), not (*, 4)"));
    EXPECT_EQ(shape.where(), path() + ":/samples/cloth");
    const Error missing = error_of([&] { file.read<float>("/samples/pose"); });
    EXPECT_THAT(missing.what(), HasSubstr("no such dataset"));
    EXPECT_EQ(missing.where(), path() + ":/samples/pose");
    EXPECT_THAT(error_of([&] { file.read<float>("/samples"); }).what(), HasSubstr("no such dataset"));
}

TEST_F(Hdf5FileTest, RefusesIntegersOutOfRange) {
    Hdf5File file = Hdf5File::create(path());
    file.write("/large", std::vector<int64_t>{1, int64_t{1} << 40}, {2});
    file.write("/negative", std::vector<int8_t>{-1}, {1});
    EXPECT_THAT(error_of([&] { file.read<int32_t>("/large"); }).what(), HasSubstr("1099511627776, out of range"));
    EXPECT_THAT(error_of([&] { file.read<uint8_t>("/negative"); }).what(), HasSubstr("-1, out of range"));
}

TEST_F(Hdf5FileTest, RefusesWhatTheFileCannotHold) {
    Hdf5File file = Hdf5File::create(path());
    file.create_rows<double>("/some", 1000, {3}, 4);  // never written, but not many
    file.create_rows<double>("/many", int64_t{1} << 30, {3}, 4);
    file.create_rows<double>("/overflow", int64_t{1} << 61, {3}, 4);
    file.create_rows<float>("/chunk", 1, {1 << 28}, 4);
    file.close();
    const Hdf5File again = Hdf5File::open(path());
    EXPECT_EQ(again.read<double>("/some").value, std::vector<double>(3000, 0.0));
    for (const char* name : {"/many", "/overflow"}) {
        EXPECT_THAT(error_of([&] { again.read<double>(name); }).what(), HasSubstr("it claims to ")) << name;
        EXPECT_THAT(error_of([&] { again.read_rows<double>(name, 7, 2); }).what(), HasSubstr("it claims to ")) << name;
    }
    EXPECT_THAT(error_of([&] { again.read<float>("/chunk"); }).what(), HasSubstr("268435456 values"));
}

TEST_F(Hdf5FileTest, RefusesFilesThatAreNotHdf5) {
    EXPECT_THAT(error_of([&] { Hdf5File::open(path("none.h5")); }).what(), HasSubstr("does not exist"));
    EXPECT_THAT(error_of([&] { Hdf5File::open(folder_.string()); }).what(), HasSubstr("folder"));
    std::ofstream(path("empty.h5")).close();
    EXPECT_THAT(error_of([&] { Hdf5File::open(path("empty.h5")); }).what(), HasSubstr("empty"));
    std::ofstream(path("text.h5")) << "pose = 1\n";
    EXPECT_THAT(error_of([&] { Hdf5File::open(path("text.h5")); }).what(), HasSubstr("not an HDF5 file"));
}

TEST_F(Hdf5FileTest, RefusesTruncatedFiles) {
    const std::string whole = bytes_of(valid());
    for (const double share : {0.1, 0.5, 0.9, 0.999}) {
        const size_t size = static_cast<size_t>(share * static_cast<double>(whole.size()));
        std::ofstream(path("cut.h5"), std::ios::binary) << whole.substr(0, size);
        EXPECT_THAT(error_of([&] { Hdf5File::open(path("cut.h5")); }).what(),
                    testing::AnyOf(HasSubstr("truncated"), HasSubstr("not an HDF5 file")));
    }
}

TEST_F(Hdf5FileTest, NoticesDamagedChunks) {
    valid();
    std::string bytes = bytes_of(path());
    const float third[] = {1, 2, 3};
    Hdf5File file = Hdf5File::create(path());
    file.create_rows<float>("/rows", 1, {3}, 0);  // not compressed, so that the values can be found in the file
    file.write_row("/rows", 0, third);
    file.close();
    bytes = bytes_of(path());
    const size_t at = bytes.find(std::string(reinterpret_cast<const char*>(third), sizeof third));
    ASSERT_NE(at, std::string::npos);
    bytes[at] ^= 1;
    std::ofstream(path(), std::ios::binary) << bytes;
    EXPECT_THAT(error_of([&] { Hdf5File::open(path()).read<float>("/rows"); }).what(), HasSubstr("cannot be read"));
}

/// Number of damaged files that were refused, of `trials`; `whole` is a file of `Hdf5FileTest::valid`.
int refused_of(int trials, const std::string& whole, const std::string& path) {
    unsigned state = 1;
    int refused = 0;
    for (int trial = 0; trial < trials; ++trial) {
        std::string bytes = whole;
        for (int k = 0; k < 8; ++k) {
            state = state * 1664525u + 1013904223u;
            bytes[state % bytes.size()] ^= static_cast<char>(1 + (state >> 24) % 255);
        }
        std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
        try {
            const Hdf5File file = Hdf5File::open(path);
            file.read<float>("/samples/cloth");
            file.read_strings("/body/joint_name");
            file.string_attribute("/", "format");
        } catch (const Error&) {
            ++refused;
        }
    }
    return refused;
}

TEST_F(Hdf5FileTest, SurvivesRandomDamageInSilence) {
    const std::string whole = bytes_of(valid());
    // In a process of its own: the library leaks what it had read of a damaged file.
    EXPECT_EXIT(std::_Exit(refused_of(200, whole, path("bad.h5")) > 100 ? 0 : 1), testing::ExitedWithCode(0), "^$");
}

TEST_F(Hdf5FileTest, RefusesPlacesItMayNotWriteTo) {
    EXPECT_THAT(error_of([&] { Hdf5File::create(path("none/a.h5")); }).what(), HasSubstr("folder does not exist"));
    std::ofstream(path("file")).close();
    EXPECT_THAT(error_of([&] { Hdf5File::create(path("file/a.h5")); }).what(), HasSubstr("not a folder"));
    if (geteuid() == 0) return;  // root may write everywhere
    ::chmod(folder_.c_str(), 0500);
    EXPECT_THAT(error_of([&] { Hdf5File::create(path("new.h5")); }).what(), HasSubstr("no permission"));
    ::chmod(folder_.c_str(), 0700);
}

TEST_F(Hdf5FileTest, NoticesAFullDiskWhileWriting) {
    const FileSizeLimit limit(100000);
    Hdf5File file = Hdf5File::create(path());
    file.create_rows<double>("/rows", 100, {1000}, 0);
    const std::vector<double> row(1000, 0.5);
    int written = 0;
    const Error error = error_of([&] {
        for (; written < 100; ++written) file.write_row("/rows", written, row.data());
    });
    EXPECT_THAT(error.what(), HasSubstr("largest size"));
    EXPECT_LE(written, 12);
    EXPECT_GT(written, 0);
    EXPECT_THROW(file.close(), Error);
}

TEST_F(Hdf5FileTest, NoticesAFullDiskAtEverySizeAtTheLatestWhenClosing) {
    const auto size = static_cast<rlim_t>(std::filesystem::file_size(valid()));
    for (rlim_t limit_bytes = 0; limit_bytes < size; limit_bytes += size / 23 + 1) {
        const FileSizeLimit limit(limit_bytes);
        EXPECT_THROW(valid("full.h5"), Error) << limit_bytes;
    }
    const FileSizeLimit limit(size);
    EXPECT_NO_THROW(valid("fits.h5"));
}

TEST_F(Hdf5FileTest, EditAddsAndRemoves) {
    valid();
    Hdf5File file = Hdf5File::edit(path());
    file.remove("/samples/id");
    file.write("/samples/id", std::vector<int64_t>{1, 2}, {2});
    file.close();
    EXPECT_EQ(Hdf5File::open(path()).read<int64_t>("/samples/id").value, (std::vector<int64_t>{1, 2}));
}

TEST_F(Hdf5FileTest, ThreadsMayReadSideBySide) {
    valid();
    std::vector<std::thread> thread;
    std::vector<int> good(4, 0);
    for (int t = 0; t < 4; ++t)
        thread.emplace_back([&, t] {
            for (int k = 0; k < 20; ++k)
                good[t] += Hdf5File::open(path()).read<float>("/samples/cloth").value.size() == 6;
        });
    for (std::thread& one : thread) one.join();
    EXPECT_EQ(good, std::vector<int>(4, 20));
}

}  // namespace
}  // namespace toile::files
