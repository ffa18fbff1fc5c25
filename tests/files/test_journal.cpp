#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/journal.h"
#include "tests/support/file_size_limit.h"

namespace toile::files {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class JournalTest : public ::testing::Test {
  protected:
    JournalTest() {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~JournalTest() override { fs::remove_all(folder_); }

    std::string path() const { return (folder_ / "journal_00000").string(); }

    std::vector<std::string> records() const {
        const Journal journal(path());
        std::vector<std::string> record;
        for (int k = 0; k < journal.count(); ++k) record.push_back(journal.read(k));
        return record;
    }

    void write_three() const {
        Journal journal(path());
        for (const char* text : {"one", "", "three"}) journal.append(text);
    }

    void flip_byte(std::int64_t offset) const {
        std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(offset);
        const char byte = static_cast<char>(file.get() ^ 1);
        file.seekp(offset);
        file.put(byte);
    }

  private:
    fs::path folder_ = fs::temp_directory_path() / ("toile_journal_" + std::to_string(::getpid()));
};

TEST_F(JournalTest, KeepsWhatWasAppended) {
    write_three();
    EXPECT_THAT(records(), ElementsAre("one", "", "three"));
    Journal(path()).append(std::string(1 << 20, 'x'));
    EXPECT_EQ(records().size(), 4u);
    EXPECT_EQ(records()[3], std::string(1 << 20, 'x'));
}

TEST_F(JournalTest, CutsATornRecordOffWhereverItIsTorn) {
    write_three();
    const auto whole = static_cast<std::int64_t>(fs::file_size(path()));
    const std::int64_t two = whole - 48 - 5;  // a heading has 48 bytes
    for (std::int64_t size = two; size < whole; ++size) {
        write_three();
        fs::resize_file(path(), static_cast<std::uintmax_t>(size));
        EXPECT_THAT(records(), ElementsAre("one", "")) << size;
        Journal(path()).append("again");
        EXPECT_THAT(records(), ElementsAre("one", "", "again")) << size;
        fs::remove(path());
    }
}

TEST_F(JournalTest, CutsOffWhatAPowerCutLeftBehindTheLastRecord) {
    write_three();
    std::ofstream(path(), std::ios::app | std::ios::binary) << std::string(4096, '\0');
    EXPECT_THAT(records(), ElementsAre("one", "", "three"));
}

TEST_F(JournalTest, PassesOverADamagedRecordAndKeepsThoseBehindIt) {
    write_three();
    flip_byte(48);  // the first byte of "one"
    EXPECT_THAT(records(), ElementsAre("", "three"));
    EXPECT_EQ(Journal(path()).damaged(), 1);
}

TEST_F(JournalTest, FindsTheRecordsBehindADamagedHeading) {
    for (const int byte : {0, 7, 8, 15, 20}) {  // mark, lowest and highest byte of the length, digest
        fs::remove(path());
        write_three();
        flip_byte(byte);
        EXPECT_THAT(records(), ElementsAre("", "three")) << byte;
        EXPECT_EQ(Journal(path()).damaged(), 1) << byte;
    }
    fs::remove(path());
    {
        Journal journal(path());
        journal.append(std::string((1 << 20) - 4, 'x'));  // the next mark lies across two reads of the search
        journal.append("two");
    }
    flip_byte(0);
    EXPECT_THAT(records(), ElementsAre("two"));
}

TEST_F(JournalTest, NoticesARecordThatChangesUnderIt) {
    write_three();
    const Journal journal(path());
    flip_byte(48);
    EXPECT_THROW(journal.read(0), Error);
    EXPECT_EQ(journal.read(2), "three");
}

TEST_F(JournalTest, IsAsBeforeAfterTheDiskWasFull) {
    write_three();
    Journal journal(path());
    {
        const test::FileSizeLimit limit(fs::file_size(path()) + 60);
        try {
            journal.append(std::string(100, 'x'));
            FAIL() << "was written beyond the limit";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("the journal cannot be written"));
        }
    }
    EXPECT_EQ(journal.count(), 3);
    journal.append("after");
    EXPECT_THAT(records(), ElementsAre("one", "", "three", "after"));
}

TEST_F(JournalTest, LosesAtMostOneRecordToAKill) {
    for (int round = 0; round < 20; ++round) {
        fs::remove(path());
        int pipe_end[2];
        ASSERT_EQ(::pipe(pipe_end), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            Journal journal(path());
            for (char k = 0;; ++k) {
                journal.append(std::string(5000, static_cast<char>('a' + k % 26)));
                if (::write(pipe_end[1], &k, 1) != 1) ::_exit(1);
            }
        }
        ::close(pipe_end[1]);
        char last = -1;
        for (int k = 0; k <= round; ++k) ASSERT_EQ(::read(pipe_end[0], &last, 1), 1);
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        for (char more = 0; ::read(pipe_end[0], &more, 1) == 1;) last = more;
        ::close(pipe_end[0]);
        const std::vector<std::string> record = records();
        ASSERT_GE(static_cast<int>(record.size()), last + 1);
        for (size_t k = 0; k < record.size(); ++k)
            ASSERT_EQ(record[k], std::string(5000, static_cast<char>('a' + k % 26)));
    }
}

TEST_F(JournalTest, RefusesWhatIsNoFile) {
    fs::create_directory(path());
    EXPECT_THROW(Journal{path()}, Error);
    EXPECT_THROW(Journal{path() + "/there/is/no/folder"}, Error);
}

}  // namespace
}  // namespace toile::files
