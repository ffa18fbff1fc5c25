#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include "tests/app/small_corpus.h"

namespace toile::app {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::HasSubstr;

/// What ends a run from outside. TOILE_FAULT_RUNS sets how many runs are killed.
class CliFaults : public SmallCorpus {
  protected:
    void SetUp() override {
        SmallCorpus::SetUp();
        make_reference();
    }
    static int runs() {
        const char* const wanted = std::getenv("TOILE_FAULT_RUNS");
        return wanted ? std::atoi(wanted) : 6;
    }
    /// Somewhere between the start and a little after the end of an undisturbed run.
    void sleep_for_some_of_a_run(std::mt19937& random) const {
        std::this_thread::sleep_for(std::uniform_real_distribution<>(0.0, 1.1)(random) * undisturbed_);
    }
    /// No process of the group is left, but for those that are ending.
    static void expect_group_ends(pid_t group) {
        for (int i = 0; i < 1000 && ::kill(-group, 0) == 0; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        EXPECT_NE(::kill(-group, 0), 0) << "a worker is left";
    }
};

TEST_F(CliFaults, KilledAtAnyMomentItResumesToTheSameBytes) {
    for (int k = 0; k < runs() && !HasFailure(); ++k) {
        SCOPED_TRACE("run " + std::to_string(k));
        std::mt19937 random(static_cast<unsigned>(k));
        fs::remove_all(path("d"));
        const int kills = 1 + k % 3;
        for (int kill = 0; kill < kills; ++kill) {
            const pid_t process = launch("generate scene.toml --out d --resume --jobs " + std::to_string(1 + k % 2));
            sleep_for_some_of_a_run(random);
            ::kill(process, SIGKILL);
            EXPECT_THAT(wait(process), AnyOf(1000 + SIGKILL, 0)) << said();
            if (kill + 1 == kills) expect_group_ends(process);
        }
        expect_resumes("d");
    }
}

TEST_F(CliFaults, ShardsKilledAtAnyMomentAreFilledByOneResume) {
    std::mt19937 random(7);
    for (const char* shard : {"0/3", "2/3", "1/3"}) {
        const pid_t process = launch(std::string("generate scene.toml --out d --jobs 1 --shard ") + shard);
        sleep_for_some_of_a_run(random);
        ::kill(process, SIGKILL);
        EXPECT_THAT(wait(process), AnyOf(1000 + SIGKILL, 0)) << said();
    }
    const Outcome filled = run("generate scene.toml --out d --resume --jobs 2");
    ASSERT_EQ(filled.status, 0) << filled.err;
    const Outcome merged = run("merge d --copy");
    ASSERT_EQ(merged.status, 0) << merged.err;
    EXPECT_TRUE(bytes("d/dataset.h5") == bytes("reference/dataset.h5"));
}

TEST_F(CliFaults, WorkersThatAreKilledOverAndOverCostSamplesNotTheRun) {
    std::mt19937 random(3);
    const pid_t process = launch("generate scene.toml --out d --jobs 2");
    wait_for(process, "d/shard_00000_of_00001/progress.json");
    for (int k = 0; k < 6; ++k) {
        std::this_thread::sleep_for(std::uniform_real_distribution<>(0.0, 0.3)(random) * undisturbed_);
        for (const pid_t worker : children_of(process)) {
            ::kill(worker, SIGSEGV);
            break;
        }
    }
    // 1 where workers were killed twice in a row before they had begun
    EXPECT_THAT(wait(process), AnyOf(0, 1, 3)) << said();
    expect_group_ends(process);
    expect_resumes("d");
}

TEST_F(CliFaults, CtrlCEndsAllAtOnceAndKeepsWhatIsDone) {
    const pid_t process = launch("generate scene.toml --out d --jobs 2 --set poses.count=400");
    wait_for(process, "d/shard_00000_of_00001/part_00000.h5");
    ::kill(-process, SIGINT);  // as a terminal does: to the workers too
    EXPECT_EQ(wait(process), 1);
    expect_group_ends(process);
    EXPECT_THAT(said(), HasSubstr("toile: interrupted"));
    EXPECT_THAT(said(), HasSubstr("--resume"));
    EXPECT_TRUE(fs::exists(path("d/shard_00000_of_00001/part_00000.h5")));
    const std::string progress = bytes("d/shard_00000_of_00001/progress.json");
    EXPECT_THAT(progress, HasSubstr("\"stopped\""));
}

TEST_F(CliFaults, ASecondWorkerOnAShardIsRefused) {
    const pid_t process = launch("generate scene.toml --out d --jobs 1 --shard 0/2");
    wait_for(process, "d/shard_00000_of_00002/lock");
    ::kill(process, SIGSTOP);
    const Outcome second = run("generate scene.toml --out d --jobs 1 --shard 0/2 --resume");
    EXPECT_EQ(second.status, 2);
    EXPECT_THAT(second.err, HasSubstr("another process is at work on this shard"));
    EXPECT_EQ(run("generate scene.toml --out d --jobs 1 --shard 1/2").status, 0) << "the other shard is free";
    ::kill(process, SIGCONT);
    EXPECT_EQ(wait(process), 0) << said();
    ASSERT_EQ(run("merge d --copy").status, 0);
    EXPECT_TRUE(bytes("d/dataset.h5") == bytes("reference/dataset.h5"));
}

TEST_F(CliFaults, AClockThatWasSetBackChangesNothing) {
    const pid_t process = launch("generate scene.toml --out d --jobs 1");
    wait_for(process, "d/shard_00000_of_00001/part_00000.h5");
    ::kill(process, SIGKILL);
    wait(process);
    // What the killed run wrote is of tomorrow.
    for (const std::string& name : files_in("d"))
        fs::last_write_time(path("d/" + name), fs::file_time_type::clock::now() + std::chrono::hours(24));
    std::string progress = bytes("d/shard_00000_of_00001/progress.json");
    const std::size_t at = progress.find("\"updated\":");
    ASSERT_NE(at, std::string::npos);
    progress.insert(at + 10, "9");
    write("d/shard_00000_of_00001/progress.json", progress);
    const Outcome status = run("status d");
    EXPECT_EQ(status.status, 0) << status.err << status.out;
    expect_resumes("d");
}

TEST_F(CliFaults, TooLittleMemoryFailsSamplesOrTheRunButNeverHangs) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the address sanitizer maps more than any limit";
#endif
    std::set<int> status;
    for (const int megabytes : {4, 16, 32, 64, 4000}) {
        SCOPED_TRACE(std::to_string(megabytes) + " MB");
        fs::remove_all(path("d"));
        const Outcome outcome =
            run("generate scene.toml --out d --jobs 2 --memory-limit " + std::to_string(megabytes) + "MB");
        EXPECT_THAT(outcome.status, AnyOf(0, 1, 2, 3)) << outcome.err;
        if (outcome.status == 1 || outcome.status == 2) {
            EXPECT_THAT(outcome.err, HasSubstr("memory"));
        }
        status.insert(outcome.status);
        expect_resumes("d");
    }
    EXPECT_EQ(status.count(0), 1u) << "4 GB are enough";
    EXPECT_GT(status.size(), 1u) << "4 MB are not";
}

}  // namespace
}  // namespace toile::app
