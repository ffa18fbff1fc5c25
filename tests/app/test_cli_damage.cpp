#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "files/dataset_file.h"
#include "tests/app/small_corpus.h"

namespace toile::app {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// What spoils a corpus' files, or the disk they are on.
class CliDamage : public SmallCorpus {
  protected:
    static constexpr const char* shard = "d/shard_00000_of_00002";

    void TearDown() override {
        if (mounted_) ::umount2(path("disk").c_str(), MNT_DETACH);
        SmallCorpus::TearDown();
    }
    /// A shard of four samples: a part of three, and one of one.
    void make_shard() {
        const Outcome outcome = run("generate scene.toml --out d --jobs 1 --shard 0/2");
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        kept_ = digests();
        ASSERT_EQ(kept_.size(), 4u);
    }
    /// Digests of the shard's samples, after they were found right.
    std::vector<files::Digest> digests() const {
        std::vector<files::Digest> digest;
        for (const char* part : {"/part_00000.h5", "/part_00001.h5"}) {
            const files::DatasetReader reader(path(shard + std::string(part)));
            for (int row = 0; row < reader.sample_count(); ++row) {
                digest.push_back(files::sample_digest(reader.read(row)));
                EXPECT_EQ(digest.back(), reader.stored_digest(row)) << part << " " << row;
            }
        }
        return digest;
    }
    Outcome expect_shard_mended() {
        const Outcome outcome = run("generate scene.toml --out d --jobs 1 --shard 0/2 --resume");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(run(std::string("validate ") + shard + "/part_00000.h5").status, 0);
        EXPECT_TRUE(digests() == kept_);
        return outcome;
    }
    /// A run that was killed with two samples in a journal, in folder d.
    void make_journal() {
        const pid_t process = launch("generate scene.toml --out d --jobs 1");
        wait_for(process, "d/shard_00000_of_00001/part_00001.h5");
        const std::string journal = path("d/shard_00000_of_00001/journal_00002");
        wait_for(process, "d/shard_00000_of_00001/journal_00002");
        for (int i = 0; i < 2000 && fs::exists(journal) && fs::file_size(journal) < 1000; ++i) ::usleep(1000);
        ::kill(process, SIGKILL);
        wait(process);
    }
    /// A disk of its own; false where this user may not mount one.
    bool mount_disk(const std::string& size) {
        fs::create_directories(path("disk"));
        mounted_ = ::mount("none", path("disk").c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
        return mounted_;
    }
    void change_disk(unsigned long flags, const std::string& size) const {
        ASSERT_EQ(::mount("none", path("disk").c_str(), "tmpfs", MS_REMOUNT | flags, ("size=" + size).c_str()), 0);
    }

    std::vector<files::Digest> kept_;
    bool mounted_ = false;
};

TEST_F(CliDamage, ABitFlippedInASealedPartIsFoundAndItsSampleMadeAgain) {
    make_shard();
    const std::string part = shard + std::string("/part_00000.h5"), sound = bytes(part);
    std::mt19937_64 random(1);
    int found = 0;
    for (int k = 0; k < 12 && !HasFailure(); ++k) {
        const size_t bit = std::uniform_int_distribution<size_t>(0, 8 * sound.size() - 1)(random);
        SCOPED_TRACE("bit " + std::to_string(bit));
        write(part, sound);
        flip_bit(part, bit);
        const Outcome outcome = expect_shard_mended();
        found += (outcome.out + outcome.err).find("made again") != std::string::npos;
    }
    EXPECT_GT(found, 0);
}

TEST_F(CliDamage, ADamagedSampleIsNamed) {
    make_shard();
    const std::string part = shard + std::string("/part_00000.h5");
    {
        files::Hdf5File file = files::Hdf5File::edit(path(part));
        file.remove("/certificate/max_speed");
        file.write("/certificate/max_speed", std::vector<double>(3, 0.0625), {3});
        file.close();
    }
    const Outcome outcome = expect_shard_mended();
    EXPECT_THAT(outcome.out + outcome.err, HasSubstr("pose 1 in"));
    EXPECT_THAT(outcome.out + outcome.err, HasSubstr("is damaged, and is made again"));
}

TEST_F(CliDamage, ATruncatedOrEmptyPartIsMadeAgain) {
    make_shard();
    const std::string part = shard + std::string("/part_00000.h5"), sound = bytes(part);
    for (const size_t left : {size_t{0}, size_t{1}, sound.size() / 2, sound.size() - 1}) {
        SCOPED_TRACE(std::to_string(left) + " bytes left");
        write(part, sound.substr(0, left));
        const Outcome outcome = expect_shard_mended();
        EXPECT_THAT(outcome.out + outcome.err, HasSubstr("made again"));
    }
    fs::remove(path(part));
    expect_shard_mended();
}

TEST_F(CliDamage, AJournalDamagedAnywhereCostsWhatWasInIt) {
    make_reference();
    make_journal();
    fs::copy(path("d"), path("kept"), fs::copy_options::recursive);
    const std::string journal = "d/shard_00000_of_00001/journal_00002", sound = bytes(journal);
    ASSERT_GT(sound.size(), 0u);
    std::mt19937_64 random(2);
    const auto start_over = [&] {
        fs::remove_all(path("d"));
        fs::copy(path("kept"), path("d"), fs::copy_options::recursive);
    };
    for (const size_t bit : {size_t{3}, size_t{70}, size_t{8 * 48 + 5},
                             std::uniform_int_distribution<size_t>(0, 8 * sound.size() - 1)(random)}) {
        SCOPED_TRACE("bit " + std::to_string(bit));
        start_over();
        flip_bit(journal, bit);
        expect_resumes("d");
    }
    for (const size_t left : {size_t{0}, size_t{20}, sound.size() - 1}) {
        SCOPED_TRACE(std::to_string(left) + " bytes left");
        start_over();
        write(journal, sound.substr(0, left));
        expect_resumes("d");
    }
}

TEST_F(CliDamage, AFinishedDataSetThatWasDamagedIsMended) {
    make_reference();
    fs::copy(path("reference"), path("d"), fs::copy_options::recursive);
    expect_resumes("d");
    const size_t size = bytes("d/dataset.h5").size();
    flip_bit("d/dataset.h5", 8 * (size / 2) + 1);
    expect_resumes("d");
    write("d/dataset.h5", bytes("d/dataset.h5").substr(0, size / 3));
    expect_resumes("d");
}

TEST_F(CliDamage, AnotherConfigurationIsRefusedAndChangesNothing) {
    make_reference();
    make_shard();
    const std::string other = " --resume --set scene.seed=2";
    expect_refused("generate scene.toml --out d --shard 0/2" + other, "another configuration");
    expect_refused("generate scene.toml --out d --shard 1/2" + other, "another configuration");
    expect_refused("generate scene.toml --out reference" + other, "");
    expect_shard_mended();
    EXPECT_EQ(run("generate scene.toml --out reference --resume").status, 0) << "its own still fits";
    // A shard that was copied in from elsewhere.
    ASSERT_EQ(run("generate scene.toml --out e --jobs 1 --shard 0/2 --set scene.seed=2").status, 0);
    fs::remove_all(path(shard));
    fs::copy(path("e/shard_00000_of_00002"), path(shard), fs::copy_options::recursive);
    expect_refused("generate scene.toml --out d --shard 0/2 --resume", "another corpus");
}

TEST_F(CliDamage, AFullDiskStopsTheRunAndLosesNothing) {
    make_reference();
    for (const int kilobytes : {16, 150, 400}) {
        SCOPED_TRACE(std::to_string(kilobytes) + " kB");
        if (!mount_disk(std::to_string(kilobytes) + "k")) GTEST_SKIP() << "this user may not mount a small disk";
        const Outcome outcome = run("generate scene.toml --out disk/d --jobs 2");
        EXPECT_THAT(outcome.status, AnyOf(1, 2)) << outcome.out;
        EXPECT_THAT(outcome.err, HasSubstr("the disk is full"));
        EXPECT_THAT(outcome.err, Not(HasSubstr("internal failure")));
        change_disk(0, "50m");
        expect_resumes("disk/d");
        ASSERT_EQ(::umount2(path("disk").c_str(), MNT_DETACH), 0);
        mounted_ = false;
    }
}

TEST_F(CliDamage, ALargestFileSizeStopsTheRunAndLosesNothing) {
    make_reference();
    for (const int blocks : {1, 40, 200}) {  // of 512 B or 1 kB, by the shell
        SCOPED_TRACE(std::to_string(blocks) + " blocks");
        fs::remove_all(path("d"));
        const Outcome outcome =
            run("generate scene.toml --out d --jobs 2", "ulimit -f " + std::to_string(blocks) + ";");
        EXPECT_THAT(outcome.status, AnyOf(1, 2)) << outcome.out;
        EXPECT_THAT(outcome.err, Not(HasSubstr("internal failure"))) << outcome.err;
        expect_resumes("d");
    }
}

TEST_F(CliDamage, AReadOnlyDiskIsRefusedAndResumesWhenItIsWritable) {
    make_reference();
    if (!mount_disk("50m")) GTEST_SKIP() << "this user may not mount a disk";
    fs::create_directories(path("disk/d"));
    change_disk(MS_RDONLY, "50m");
    expect_refused("generate scene.toml --out disk/d", "cannot be written to");
    change_disk(0, "50m");
    const pid_t process = launch("generate scene.toml --out disk/d --jobs 1");
    wait_for(process, "disk/d/shard_00000_of_00001/part_00000.h5");
    ::kill(process, SIGKILL);
    wait(process);
    change_disk(MS_RDONLY, "50m");
    expect_refused("generate scene.toml --out disk/d --resume", "");
    change_disk(0, "50m");
    expect_resumes("disk/d");
}

TEST_F(CliDamage, AFolderThatVanishesEndsTheRun) {
    const pid_t process = launch("generate scene.toml --out d --jobs 2 --set poses.count=400");
    wait_for(process, "d/shard_00000_of_00001/part_00000.h5");
    ::kill(process, SIGSTOP);
    fs::remove_all(path("d"));
    ::kill(process, SIGCONT);
    EXPECT_THAT(wait(process), AnyOf(1, 2)) << said();
    EXPECT_THAT(said(), HasSubstr("toile: "));
    EXPECT_THAT(said(), Not(HasSubstr("internal failure")));
}

}  // namespace
}  // namespace toile::app
