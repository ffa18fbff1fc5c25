#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "cloth/error.h"
#include "files/new_file.h"
#include "tests/support/file_size_limit.h"

namespace {

/// What was asked of the disk: "sync a.txt.partial", "rename a.txt.partial a.txt" ...
std::vector<std::string>* disk_calls = nullptr;

void note(const std::string& call) {
    if (disk_calls) disk_calls->push_back(call);
}

std::string last_name(const std::filesystem::path& path) {
    return path.filename().string();
}

}  // namespace

// These stand before the C library's in this program.
extern "C" int fsync(int descriptor) {
    std::error_code failure;
    note("sync " + last_name(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor), failure)));
    return static_cast<int>(syscall(SYS_fsync, descriptor));
}

extern "C" int rename(const char* from, const char* to) noexcept {
    note("rename " + last_name(from) + " " + last_name(to));
    return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace toile::files {
namespace {

class NewFileTest : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "a.txt").string(); }
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("toile_new_file_" + std::to_string(getpid()));
};

std::string text_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(NewFileTest, AppearsWholeAtTheCommit) {
    std::ofstream(path()) << "old";
    NewFile file(path());
    file.write("new text", 8);
    EXPECT_EQ(text_of(path()), "old");
    file.commit();
    EXPECT_EQ(text_of(path()), "new text");
    EXPECT_FALSE(std::filesystem::exists(file.partial()));
}

TEST_F(NewFileTest, ACommitSurvivesAPowerCut) {
    NewFile file(path());
    std::ofstream(file.partial()) << "by another hand";  // as HDF5 writes to it
    std::vector<std::string> calls;
    disk_calls = &calls;
    file.commit();
    disk_calls = nullptr;
    EXPECT_THAT(calls, testing::ElementsAre("sync a.txt.partial", "rename a.txt.partial a.txt",
                                            "sync " + folder_.filename().string()));
}

TEST_F(NewFileTest, WhatIsSoonReplacedIsNotSynced) {
    std::vector<std::string> calls;
    disk_calls = &calls;
    write_text_file(path(), "passing", NewFile::Survives::kill);
    disk_calls = nullptr;
    EXPECT_THAT(calls, testing::ElementsAre("rename a.txt.partial a.txt"));
    EXPECT_EQ(text_of(path()), "passing");
}

TEST_F(NewFileTest, AFileBesideTheProgramIsCommittedToo) {
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_);
    write_text_file("a.txt", "text");
    std::filesystem::current_path(before);
    EXPECT_EQ(text_of(path()), "text");
}

TEST_F(NewFileTest, LeavesNothingWithoutACommit) {
    { NewFile(path()).write("text", 4); }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(NewFileTest, AFullDiskIsAnErrorAndLeavesNothing) {
    const std::string text(5000, 'x');
    {
        const test::FileSizeLimit limit(4000);
        NewFile file(path());
        EXPECT_THROW(file.write(text.data(), text.size()), Error);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(NewFileTest, RefusesPlacesThatCannotBeWrittenTo) {
    auto message = [](const std::string& path) -> std::string {
        try {
            const NewFile file(path);
        } catch (const Error& error) {
            EXPECT_EQ(error.where(), path);
            return error.what();
        }
        return "no error";
    };
    EXPECT_THAT(message((folder_ / "none" / "a").string()), testing::HasSubstr("folder does not exist"));
    EXPECT_THAT(message(folder_.string()), testing::HasSubstr("a folder has this name"));
    std::ofstream(path()).close();
    EXPECT_THAT(message(path() + "/a"), testing::HasSubstr("not a folder"));
}

}  // namespace
}  // namespace toile::files
