#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>

#include "app/guard.h"
#include "cloth/error.h"
#include "generate/ordered_work.h"

namespace toile::app {
namespace {

std::string said(const std::function<int()>& work, int expected_status) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(guarded(work), expected_status);
    return ::testing::internal::GetCapturedStderr();
}

TEST(Guard, PassesTheStatusOfWorkThatEnds) {
    EXPECT_EQ(said([] { return 3; }, 3), "");
    EXPECT_EQ(said([] { return 0; }, 0), "");
}

TEST(Guard, SaysWhatIsWrongWhereAndTheMend) {
    EXPECT_EQ(said([]() -> int { throw Error("it is wrong", "a.toml:3", "mend it"); }, input_at_fault),
              "toile: it is wrong (a.toml:3)\nmend it\n");
    EXPECT_EQ(said([]() -> int { throw Error("it is wrong"); }, input_at_fault), "toile: it is wrong\n");
}

TEST(Guard, KeepsToOneLineWhateverANameHolds) {
    EXPECT_EQ(said([]() -> int { throw Error("a\nb\x1b[31m", "c\rd"); }, input_at_fault), "toile: a b [31m (c d)\n");
}

TEST(Guard, CutsWhatAFileMadeLong) {
    const std::string line = said([]() -> int { throw Error(std::string(100'000, 'a'), "b.toml"); }, input_at_fault);
    EXPECT_LT(line.size(), 1100u);
    EXPECT_EQ(line.substr(line.size() - 13), "... (b.toml)\n");
}

TEST(Guard, TurnsEveryExceptionIntoAStatus) {
    EXPECT_EQ(said([]() -> int { throw std::bad_alloc(); }, our_failure).rfind("toile: out of memory", 0), 0u);
    EXPECT_EQ(said([]() -> int { throw std::runtime_error("x"); }, our_failure).rfind("toile: internal failure: x", 0),
              0u);
    EXPECT_EQ(said([]() -> int { throw 7; }, our_failure).rfind("toile: internal failure", 0), 0u);
    EXPECT_EQ(said([]() -> int { throw generate::Interrupted(); }, our_failure).rfind("toile: interrupted", 0), 0u);
    EXPECT_EQ(said(
                  []() -> int {
                      throw std::filesystem::filesystem_error("x", "/a",
                                                              std::make_error_code(std::errc::permission_denied));
                  },
                  input_at_fault),
              "toile: Permission denied (/a)\n");
}

}  // namespace
}  // namespace toile::app
