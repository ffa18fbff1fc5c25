#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "cloth/error.h"
#include "files/file_lock.h"

namespace toile::files {
namespace {

class FileLockTest : public ::testing::Test {
  protected:
    ~FileLockTest() override { std::filesystem::remove(path_); }
    const std::string path_ =
        (std::filesystem::temp_directory_path() / ("toile_lock_" + std::to_string(::getpid()))).string();
};

TEST_F(FileLockTest, IsHeldByOneAtATime) {
    EXPECT_FALSE(FileLock::is_held(path_));
    {
        const std::optional<FileLock> lock = FileLock::try_take(path_);
        ASSERT_TRUE(lock);
        EXPECT_TRUE(FileLock::is_held(path_));
        EXPECT_FALSE(FileLock::try_take(path_));
    }
    EXPECT_FALSE(FileLock::is_held(path_));
    EXPECT_TRUE(FileLock::try_take(path_));
}

TEST_F(FileLockTest, EndsWithTheProcessHoweverItEnds) {
    int pipe_end[2];
    ASSERT_EQ(::pipe(pipe_end), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const FileLock lock = FileLock::take(path_);
        if (::write(pipe_end[1], "x", 1) != 1) ::_exit(1);
        for (;;) ::pause();
    }
    char ready = 0;
    ASSERT_EQ(::read(pipe_end[0], &ready, 1), 1);
    EXPECT_FALSE(FileLock::try_take(path_));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_TRUE(FileLock::try_take(path_));
}

TEST_F(FileLockTest, DoesNotOutliveItsOwnerInChildrenThatClosedIt) {
    std::optional<FileLock> lock = FileLock::try_take(path_);
    int pipe_end[2];
    ASSERT_EQ(::pipe(pipe_end), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(lock->descriptor());
        if (::write(pipe_end[1], "x", 1) != 1) ::_exit(1);
        for (;;) ::pause();
    }
    char ready = 0;
    ASSERT_EQ(::read(pipe_end[0], &ready, 1), 1);
    EXPECT_TRUE(FileLock::is_held(path_));
    lock.reset();
    EXPECT_FALSE(FileLock::is_held(path_));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
}

TEST_F(FileLockTest, NeedsAFolder) {
    EXPECT_THROW(FileLock::try_take(path_ + "/no/folder"), Error);
}

}  // namespace
}  // namespace toile::files
