#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/file_lock.h"
#include "generate/corpus_status.h"
#include "generate/shard_progress.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A corpus of 40 samples in four shards of ten.
class CorpusStatusTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder = (fs::temp_directory_path() / ("toile_status_" + std::string(info->name()) + std::to_string(getpid())))
                     .string();
        fs::create_directories(folder);
        files::CorpusPlan plan;
        plan.header = test::header_of(false, false);
        for (int slot = 0; slot < 40; ++slot) {
            plan.pose_number.push_back(100 + slot);
            plan.split.push_back(0);
        }
        files::write_plan(folder + "/plan.h5", plan);
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string shard(int index, const std::string& name = {}) const {
        const fs::path path = fs::path(folder) / shard_folder_name({index, 4});
        fs::create_directories(path);
        return (path / name).string();
    }
    /// `made_here` samples in `seconds`, of `done`.
    void say(int index, const std::string& state, std::int64_t done, std::int64_t made_here, double seconds) const {
        ShardProgress progress;
        progress.shard = index;
        progress.shards = 4;
        progress.samples = 10;
        progress.done = done;
        progress.accepted = done > 0 ? done - 1 : 0;
        if (done > 0) progress.failed = {{"not at rest", 1}};
        progress.made_here = made_here;
        progress.seconds_here = seconds;
        progress.pid = 77;
        progress.host = "node7";
        progress.state = state;
        progress.updated = -5;  // a clock set back
        write_shard_progress(shard(index, "progress.json"), progress);
    }
    std::string refusal() const {
        try {
            corpus_status(folder);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }

    std::string folder;
};

TEST_F(CorpusStatusTest, AddsUpShardsInEveryState) {
    say(0, "finished", 10, 10, 100);
    say(1, "running", 4, 2, 4);  // half a sample a second
    say(2, "running", 3, 3, 1);
    const auto lock = files::FileLock::try_take(shard(1, "lock"));  // shard 2 was killed; 3 was never begun
    const CorpusStatus status = corpus_status(folder);
    ASSERT_EQ(status.shard.size(), 4u);
    const ShardState expected[] = {ShardState::finished, ShardState::running, ShardState::stale, ShardState::not_begun};
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(status.shard[i].state, expected[i]) << i;
        EXPECT_EQ(status.shard[i].number.index, i);
        EXPECT_EQ(status.shard[i].samples, 10);
        EXPECT_EQ(status.count(expected[i]), 1);
    }
    EXPECT_EQ(status.samples, 40);
    EXPECT_EQ(status.done, 17);
    EXPECT_EQ(status.accepted, 14);
    EXPECT_EQ(status.failed.at("not at rest"), 3);
    EXPECT_EQ(status.rate, 0.5) << "of the shard at work alone";
    EXPECT_EQ(status.seconds_left, 23 / 0.5);
    EXPECT_EQ(status.shard[1].host, "node7");
    EXPECT_FALSE(status.dataset_samples);
}

TEST_F(CorpusStatusTest, TheSlowestShardMayTakeLongest) {
    say(0, "running", 0, 0, 0);
    say(1, "running", 9, 8, 1);
    say(2, "running", 5, 1, 100);
    std::vector<std::optional<files::FileLock>> lock;
    for (int i = 0; i < 3; ++i) lock.push_back(files::FileLock::try_take(shard(i, "lock")));
    const CorpusStatus status = corpus_status(folder);
    EXPECT_DOUBLE_EQ(status.rate, 8.01) << "the first has not made any yet";
    EXPECT_DOUBLE_EQ(*status.seconds_left, 500.0);
}

TEST_F(CorpusStatusTest, WhatStoppedAndWhatHasSaidNothing) {
    say(0, "stopped", 6, 6, 10);
    shard(1, "lock");
    std::ofstream(shard(2, "progress.json")) << "{ torn";
    const auto lock = files::FileLock::try_take(shard(2, "lock"));
    say(3, "finished", 9, 9, 10);  // a damaged part was found later
    const CorpusStatus status = corpus_status(folder);
    EXPECT_EQ(status.shard[0].state, ShardState::stopped);
    EXPECT_EQ(status.shard[1].state, ShardState::stopped);
    EXPECT_EQ(status.shard[2].state, ShardState::running);
    EXPECT_EQ(status.shard[3].state, ShardState::stopped);
    EXPECT_EQ(status.rate, 0);
    EXPECT_FALSE(status.seconds_left) << "nobody has made a sample yet";
}

TEST_F(CorpusStatusTest, AProcessThatWasKilledIsStale) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    say(0, "running", 2, 2, 1);
    const std::string lock_path = shard(0, "lock");
    const pid_t child = fork();
    if (child == 0) {
        const auto lock = files::FileLock::try_take(lock_path);
        char byte = 1;
        if (write(ready[1], &byte, 1) != 1) _exit(1);
        for (;;) pause();
    }
    char byte = 0;
    ASSERT_EQ(read(ready[0], &byte, 1), 1);
    EXPECT_EQ(corpus_status(folder).shard[0].state, ShardState::running);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_EQ(corpus_status(folder).shard[0].state, ShardState::stale);
    close(ready[0]);
    close(ready[1]);
}

TEST_F(CorpusStatusTest, AWholeDataSet) {
    fs::remove(folder + "/plan.h5");
    const files::DatasetHeader header = test::header_of(false, false);
    files::DatasetWriter writer(folder + "/dataset.h5", header, 5, 4);
    for (int slot = 0; slot < 5; ++slot) writer.write(slot, test::sample_of(header, slot));  // 1 and 3 failed
    writer.finish();
    const CorpusStatus status = corpus_status(folder);
    EXPECT_TRUE(status.shard.empty());
    EXPECT_EQ(status.samples, 5);
    EXPECT_EQ(status.done, 5);
    EXPECT_EQ(status.accepted, 3);
    EXPECT_EQ(status.failed.at("not at rest"), 2);
    EXPECT_EQ(status.seconds_left, 0.0);
    EXPECT_EQ(status.dataset_samples, 5);
}

TEST_F(CorpusStatusTest, BeforeTheFirstShard) {
    EXPECT_EQ(corpus_status(folder).samples, 40);
    fs::remove(folder + "/plan.h5");
    EXPECT_THAT(refusal(), HasSubstr("no corpus in this folder"));
    const auto lock = files::FileLock::try_take(folder + "/plan.lock");
    EXPECT_TRUE(corpus_status(folder).planning);
}

TEST_F(CorpusStatusTest, RefusesWhatItCannotAddUp) {
    shard(1);
    fs::create_directory(fs::path(folder) / shard_folder_name({0, 2}));
    EXPECT_THAT(refusal(), HasSubstr("into 2 and into 4"));
    fs::remove(fs::path(folder) / shard_folder_name({0, 2}));
    fs::remove(folder + "/plan.h5");
    EXPECT_THAT(refusal(), HasSubstr("does not exist"));
    folder += "/none";
    EXPECT_THAT(refusal(), HasSubstr("no corpus in this folder"));
}

TEST_F(CorpusStatusTest, JsonSaysTheSame) {
    say(0, "running", 4, 2, 4);
    const auto lock = files::FileLock::try_take(shard(0, "lock"));
    const nlohmann::json json = nlohmann::json::parse(status_json(corpus_status(folder)));
    EXPECT_EQ(json.at("samples"), 40);
    EXPECT_EQ(json.at("done"), 4);
    EXPECT_EQ(json.at("rate"), 0.5);
    EXPECT_EQ(json.at("seconds_left"), 72.0);
    EXPECT_TRUE(json.at("dataset_samples").is_null());
    EXPECT_EQ(json.at("failed").at("not at rest"), 1);
    ASSERT_EQ(json.at("shards").size(), 4u);
    EXPECT_EQ(json.at("shards")[0].at("state"), "running");
    EXPECT_EQ(json.at("shards")[3].at("state"), "not begun");
}

}  // namespace
}  // namespace toile::generate
