#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "cloth/error.h"
#include "generate/merge.h"
#include "generate/ordered_work.h"
#include "generate/validate.h"
#include "tests/generate/tiny_dataset.h"
#include "tests/support/one_triangle_dataset.h"
#include "tests/support/sharded_corpus.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Flips a bit of one of the cloths' numbers, where neither its checksum nor its compression hides it.
void damage_cloth(const std::string& path, int row) {
    files::Hdf5File file = files::Hdf5File::edit(path);
    const files::Array<float> cloth = file.read<float>("/samples/cloth");
    std::vector<float> value = cloth.value;
    value[static_cast<size_t>(row) * value.size() / static_cast<size_t>(cloth.shape[0])] += 1;
    file.write_rows("/samples/cloth", 0, cloth.shape[0], value.data());
    file.close();
}

/// Eleven samples, poses 100 to 110, in three shards of parts of two; pose 104 is not accepted.
class MergeTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        root_ = fs::temp_directory_path() / ("toile_merge_" + std::string(info->name()) + std::to_string(getpid()));
        folder = (root_ / "corpus").string();
        single = (root_ / "single" / "dataset.h5").string();
        fs::create_directories(root_ / "single");
        write_single(single, [](files::DatasetHeader&) {});
        test::write_corpus(single, folder, 3, 2);
    }
    void TearDown() override { fs::remove_all(root_); }

    void write_single(const std::string& path, const std::function<void(files::DatasetHeader&)>& change) const {
        files::DatasetHeader header = test::header_of(true, true);
        change(header);
        files::DatasetWriter writer(path, header, 11, 4);
        for (int slot = 0; slot < 11; ++slot) {
            files::SampleRecord sample = test::sample_of(header, slot);
            sample.status = slot == 4;
            writer.write(slot, sample);
        }
        writer.finish();
    }
    std::string part(int shard, int number) const { return test::part_path(folder, {shard, 3}, number); }
    std::string dataset() const { return folder + "/dataset.h5"; }
    MergeSummary merged(bool copy = false) const {
        MergeOptions options;
        options.copy = copy;
        return merge(folder, options);
    }
    std::vector<std::int64_t> ids() const {
        return files::Hdf5File::open(dataset()).read<std::int64_t>("/samples/id").value;
    }
    /// The message, with what lies between bars: where and the mend.
    std::string refusal() const {
        const bool was_there = fs::exists(dataset());
        try {
            merged();
        } catch (const Error& error) {
            EXPECT_EQ(fs::exists(dataset()), was_there);
            EXPECT_FALSE(error.mend().empty()) << error.what();
            return error.what() + std::string("|") + error.where() + "|" + error.mend();
        }
        return "no error";
    }

    fs::path root_;
    std::string folder, single;
};

TEST_F(MergeTest, ACopyIsTheFileOfASingleRun) {
    const MergeSummary summary = merged(true);
    EXPECT_EQ(summary.dataset, dataset());
    EXPECT_EQ(summary.shards, 3);
    EXPECT_EQ(summary.parts, 6);
    EXPECT_EQ(summary.samples, 11);
    EXPECT_EQ(summary.accepted, 10);
    EXPECT_THAT(summary.missing, IsEmpty());
    EXPECT_THAT(summary.damaged, IsEmpty());
    ASSERT_EQ(summary.failed.size(), 1u);
    EXPECT_EQ(summary.failed[0].pose, 104);
    EXPECT_EQ(summary.failed[0].replay, "");
    EXPECT_FALSE(summary.is_complete());
    EXPECT_TRUE(bytes_of(dataset()) == bytes_of(single));
    EXPECT_TRUE(bytes_of(folder + "/dataset.timing.h5") == bytes_of((root_ / "single/dataset.timing.h5").string()));
}

TEST_F(MergeTest, WhatRefersToTheShardsReadsTheSameAndMovesWithThem) {
    merged();
    EXPECT_EQ(files::Hdf5File::open(dataset()).virtual_rows("/samples/image").size(), 6u);
    fs::rename(folder, root_ / "moved");
    const files::DatasetReader joined((root_ / "moved/dataset.h5").string()), whole(single);
    ASSERT_EQ(joined.sample_count(), 11);
    EXPECT_EQ(joined.header().resampling_error, whole.header().resampling_error);
    for (int slot = 0; slot < 11; ++slot) {
        test::expect_same(joined.read(slot), whole.read(slot));
        EXPECT_EQ(joined.stored_digest(slot), whole.stored_digest(slot));
    }
}

TEST_F(MergeTest, IsIdempotent) {
    for (const bool copy : {false, true}) {
        merged(copy);
        const std::string first = bytes_of(dataset()), timing = bytes_of(folder + "/dataset.timing.h5");
        merged(copy);
        EXPECT_TRUE(bytes_of(dataset()) == first);
        EXPECT_TRUE(bytes_of(folder + "/dataset.timing.h5") == timing);
    }
}

TEST_F(MergeTest, GapsAreListedAndLeftOut) {
    fs::remove(part(0, 1));                              // slot 2
    fs::remove_all(fs::path(part(1, 0)).parent_path());  // slots 3 to 6
    const MergeSummary summary = merged();
    EXPECT_EQ(summary.shards, 2);
    EXPECT_EQ(summary.samples, 6);
    EXPECT_THAT(summary.missing, ElementsAre(102, 103, 104, 105, 106));
    EXPECT_THAT(ids(), ElementsAre(100, 101, 107, 108, 109, 110));
    test::write_shard(single, folder, {0, 3}, 2);
    test::write_shard(single, folder, {1, 3}, 2);
    EXPECT_THAT(merged(true).missing, IsEmpty());
    EXPECT_TRUE(bytes_of(dataset()) == bytes_of(single)) << "the gaps are filled";
}

TEST_F(MergeTest, DamagedSamplesAreNamedAndLeftOut) {
    damage_cloth(part(1, 0), 1);  // slot 4
    damage_cloth(part(2, 1), 0);  // slot 9
    for (const bool copy : {false, true}) {
        const MergeSummary summary = merged(copy);
        EXPECT_THAT(summary.damaged,
                    ElementsAre(AllOf(HasSubstr("pose 104 in shard_00001_of_00003/part_00000.h5"), HasSubstr("digest")),
                                HasSubstr("pose 109 in shard_00002_of_00003/part_00001.h5")));
        EXPECT_THAT(summary.missing, IsEmpty());
        EXPECT_THAT(summary.failed, IsEmpty());
        EXPECT_THAT(ids(), ElementsAre(100, 101, 102, 103, 105, 106, 107, 108, 110));
        const files::DatasetReader joined(dataset());
        for (int slot = 0; slot < joined.sample_count(); ++slot)
            EXPECT_EQ(files::sample_digest(joined.read(slot)), joined.stored_digest(slot));
    }
}

TEST_F(MergeTest, AnyFlippedBitOrCutIsFoundAndNothingIsServedWrong) {
    const std::string sound = bytes_of(part(1, 1));
    const files::DatasetReader whole(single);
    int listed = 0;
    for (size_t at = 0; at < sound.size(); at += sound.size() / 25 + 1) {
        std::string damaged = sound;
        if (at % 3 == 0)
            damaged.resize(at);
        else
            damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        std::ofstream(part(1, 1), std::ios::binary) << damaged;
        MergeSummary summary;
        try {
            summary = merged();
        } catch (const Error& error) {
            EXPECT_THAT(error.where(), HasSubstr("part_00001.h5")) << at;
            continue;
        }
        listed += !summary.damaged.empty();
        EXPECT_EQ(summary.samples + (summary.damaged.size() == 1 && summary.missing.empty() ? 1 : 0) +
                      static_cast<int>(summary.missing.size()) +
                      (summary.damaged.size() == 2 && summary.missing.empty() ? 2 : 0),
                  11)
            << at;
        const files::DatasetReader joined(dataset());
        for (int slot = 0; slot < joined.sample_count(); ++slot) {
            const files::SampleRecord sample = joined.read(slot);
            EXPECT_EQ(files::sample_digest(sample), whole.stored_digest(static_cast<int>(sample.id) - 100)) << at;
        }
    }
    EXPECT_GT(listed, 5);
}

TEST_F(MergeTest, NothingSealedIsNothingWritten) {
    for (const int shard : {0, 1, 2}) {
        fs::remove_all(fs::path(part(shard, 0)).parent_path());
        fs::create_directory(fs::path(part(shard, 0)).parent_path());
    }
    std::ofstream(fs::path(part(0, 0)).parent_path() / "journal_00000") << "samples that are not sealed yet";
    const MergeSummary summary = merged();
    EXPECT_EQ(summary.dataset, "");
    EXPECT_EQ(summary.missing.size(), 11u);
    EXPECT_FALSE(fs::exists(dataset()));
}

TEST_F(MergeTest, RefusesFoldersWithoutACorpus) {
    fs::remove(folder + "/plan.h5");
    EXPECT_THAT(refusal(), HasSubstr("no plan.h5"));
    test::write_plan_of(single, folder);
    for (const int shard : {0, 1, 2}) fs::remove_all(fs::path(part(shard, 0)).parent_path());
    EXPECT_THAT(refusal(), HasSubstr("holds no shards"));
}

TEST_F(MergeTest, RefusesShardsOfTwoDivisions) {
    test::write_shard(single, folder, {4, 8}, 2);
    EXPECT_THAT(refusal(), AllOf(HasSubstr("into 3 and into 8"), HasSubstr("shard_00004_of_00008")));
}

TEST_F(MergeTest, RefusesPartsOfAnotherCorpus) {
    using files::DatasetHeader;
    const std::vector<std::pair<std::string, std::function<void(DatasetHeader&)>>> change{
        {"configuration has the hash f", [](DatasetHeader& h) { h.config_hash = "f"; }},
        {"toile 9.9.9 made it", [](DatasetHeader& h) { h.program_version = "9.9.9"; }},
        {"its /mesh differs", [](DatasetHeader& h) { h.mesh.rest_position(1, 1) += 1e-15; }},
        {"its /body differs", [](DatasetHeader& h) { h.body->joint_bind[1](1, 3) = 1; }},
        {"its /embedding differs", [](DatasetHeader& h) { h.embedding->triangle[1] = 1; }},
        {"its /image differs", [](DatasetHeader& h) { h.image->mask[0] = 0; }},
        {"its gate differs", [](DatasetHeader& h) { h.gate["max_stretch"] = 2; }}};
    const std::string other = (root_ / "single" / "other.h5").string();
    for (const auto& [what, apply] : change) {
        write_single(other, apply);
        test::write_shard(other, folder, {1, 3}, 2);
        EXPECT_THAT(refusal(), AllOf(HasSubstr(what), HasSubstr("shard_00001_of_00003/part_00000.h5")));
    }
}

TEST_F(MergeTest, RefusesPartsInTheWrongPlace) {
    fs::copy_file(part(1, 0), part(1, 7));
    EXPECT_THAT(refusal(), AllOf(HasSubstr("part_00001.h5 holds too"), HasSubstr("part_00007.h5")));
    fs::remove(part(1, 7));
    fs::copy_file(part(1, 0), part(0, 7));
    EXPECT_THAT(refusal(), AllOf(HasSubstr("it is from shard_00001_of_00003"), HasSubstr("part_00007.h5")));
    fs::remove(part(0, 7));
    fs::copy_file(single, part(0, 7));
    EXPECT_THAT(refusal(), HasSubstr("a data set by itself"));
    fs::remove(part(0, 7));
    EXPECT_EQ(merged().samples, 11);
}

TEST_F(MergeTest, RefusesAPlanOfOtherSamples) {
    files::CorpusPlan plan = files::read_plan(folder + "/plan.h5");
    plan.pose_number[5] = 777;
    files::write_plan(folder + "/plan.h5", plan);
    EXPECT_THAT(refusal(), HasSubstr("holds pose 105 where the plan has pose 777"));
    plan.pose_number.push_back(900);
    plan.split.push_back(0);
    files::write_plan(folder + "/plan.h5", plan);
    EXPECT_THAT(refusal(), HasSubstr("of 11 samples, the plan has 12"));
}

TEST_F(MergeTest, AnInterruptLeavesWhatWasThere) {
    merged();
    const std::string before = bytes_of(dataset());
    std::atomic<bool> interrupted{false};
    for (const std::string_view stage : {"checking", "joining"}) {
        MergeOptions options;
        options.copy = true;
        options.interrupted = &interrupted;
        options.progress = [&](const Progress& progress) {
            interrupted = progress.stage == stage && progress.done == 5;
        };
        EXPECT_THROW(merge(folder, options), Interrupted);
        EXPECT_TRUE(bytes_of(dataset()) == before);
        EXPECT_FALSE(fs::exists(dataset() + ".partial"));
        interrupted = false;
    }
}

TEST_F(MergeTest, AMergedDataSetIsValidAndAMissingPartIsNamed) {
    TinyDataset().write(single);
    fs::remove_all(folder);
    test::write_corpus(single, folder, 2, 1);
    EXPECT_TRUE(merged().is_complete());
    const Validation sound = validate_dataset(dataset());
    EXPECT_THAT(sound.defect, IsEmpty());
    EXPECT_EQ(sound.samples, TinyDataset::samples);
    EXPECT_EQ(sound.accepted, TinyDataset::samples);
    for (int shard : {0, 1})
        for (int number : {0, 1})
            EXPECT_THAT(validate_dataset(test::part_path(folder, {shard, 2}, number)).defect, IsEmpty());

    damage_cloth(test::part_path(folder, {1, 2}, 0), 0);
    EXPECT_THAT(validate_dataset(dataset()).defect, testing::Contains(HasSubstr("/samples/digest[2]")));
    fs::remove(test::part_path(folder, {1, 2}, 0));
    EXPECT_THAT(validate_dataset(dataset()).defect,
                ElementsAre(AllOf(HasSubstr("rows 2 and on are in shard_00001_of_00002/part_00000.h5"),
                                  HasSubstr("does not exist"), HasSubstr("toile merge"))));
}

TEST(RangesTextTest, RunsOfNumbers) {
    EXPECT_EQ(ranges_text({}), "");
    EXPECT_EQ(ranges_text({3}), "3");
    EXPECT_EQ(ranges_text({3, 4}), "3, 4");
    EXPECT_EQ(ranges_text({3, 4, 5, 9, 11, 12, 13}), "3 to 5, 9, 11 to 13");
    EXPECT_EQ(ranges_text({9, 3, 4, 5}), "9, 3 to 5");
}

}  // namespace
}  // namespace toile::generate
