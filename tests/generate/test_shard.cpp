#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "cloth/error.h"
#include "files/sample_bytes.h"
#include "generate/shard.h"
#include "simulate/certificate.h"
#include "tests/support/one_triangle_dataset.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A corpus of ten samples in two shards of five, sealed by twos.
class ShardTest : public ::testing::Test {
  protected:
    ShardTest() {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
        plan_.header = test::header_of(true, true);
        plan_.header.reasons.clear();
        for (const std::string_view reason : simulate::status_reasons()) plan_.header.reasons.emplace_back(reason);
        for (int slot = 0; slot < 10; ++slot) {
            plan_.pose_number.push_back(100 + slot);
            plan_.split.push_back(slot % 3);
        }
    }
    ~ShardTest() override { fs::remove_all(folder_); }

    const files::CorpusPlan& long_plan() {
        for (int slot = plan_.sample_count(); slot < 40; ++slot) {
            plan_.pose_number.push_back(100 + slot);
            plan_.split.push_back(slot % 3);
        }
        return plan_;
    }

    Shard open(int index = 1) const { return Shard(folder_.string(), {index, 2}, plan_, {2, 4}); }

    std::string sample(int slot, simulate::DrapeStatus status = simulate::DrapeStatus::accepted) const {
        files::SampleRecord record = test::sample_of(plan_.header, slot);
        record.status = static_cast<int>(status);
        return files::sample_bytes(record);
    }

    void add(const std::vector<int>& slot) const {
        Shard shard = open();
        for (const int one : slot) shard.add(one, sample(one));
    }

    std::vector<std::string> names() const {
        std::vector<std::string> name;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / shard_folder_name({1, 2})))
            if (entry.path().filename() != "lock") name.push_back(entry.path().filename().string());
        std::sort(name.begin(), name.end());
        return name;
    }

    fs::path in(const std::string& name) const { return folder_ / shard_folder_name({1, 2}) / name; }

    void flip_byte(const fs::path& path, std::uintmax_t offset) const {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(offset));
        const char byte = static_cast<char>(file.get() ^ 1);
        file.seekp(static_cast<std::streamoff>(offset));
        file.put(byte);
    }

    void expect_sealed(const std::string& name, const std::vector<int>& slot) const {
        const files::DatasetReader part(in(name).string());
        ASSERT_EQ(part.sample_count(), static_cast<int>(slot.size()));
        EXPECT_EQ(part.part()->first_slot, slot[0]);
        for (int row = 0; row < part.sample_count(); ++row) {
            EXPECT_EQ(part.read(row).id, 100 + slot[row]);
            EXPECT_EQ(files::sample_digest(part.read(row)), part.stored_digest(row));
        }
    }

    files::CorpusPlan plan_;
    const fs::path folder_ = fs::temp_directory_path() / ("toile_shard_" + std::to_string(::getpid()));
};

TEST_F(ShardTest, DividesTheSlotsWithoutGapOrOverlap) {
    for (const int samples : {0, 1, 10, 1000003})
        for (const int count : {1, 3, 16, 1000}) {
            int next = 0;
            for (int index = 0; index < count; ++index) {
                const SlotRange range = shard_slots({index, count}, samples);
                EXPECT_EQ(range.first, next);
                EXPECT_LE(std::abs(range.size() - samples / count), 1);
                next = range.end;
            }
            EXPECT_EQ(next, samples);
        }
}

TEST_F(ShardTest, SealsPartsWhoseSamplesAreThereInAnyOrder) {
    {
        Shard shard = open();
        EXPECT_THAT(shard.missing(), ElementsAre(5, 6, 7, 8, 9));
        shard.add(7, sample(7));
        shard.add(6, sample(6));
        EXPECT_THAT(names(),
                    ElementsAre("journal_00000", "journal_00001", "part_00000.h5.partial", "part_00001.h5.partial"));
        shard.add(8, sample(8));
        EXPECT_THAT(names(), ElementsAre("journal_00000", "part_00000.h5.partial", "part_00001.h5"));
        shard.add(9, sample(9));
        shard.add(5, sample(5));
        EXPECT_TRUE(shard.is_complete());
        EXPECT_EQ(shard.tally().samples, 5);
    }
    EXPECT_THAT(names(), ElementsAre("part_00000.h5", "part_00001.h5", "part_00002.h5"));
    expect_sealed("part_00000.h5", {5, 6});
    expect_sealed("part_00001.h5", {7, 8});
    expect_sealed("part_00002.h5", {9});
}

TEST_F(ShardTest, SealsTheSameFileWhateverTheOrder) {
    const auto sealed = [&](const std::vector<int>& order) {
        const std::string folder = (folder_ / "order").string();
        fs::create_directory(folder);
        Shard shard(folder, {0, 1}, long_plan(), {40, 4});
        for (const int slot : order) shard.add(slot, sample(slot));
        EXPECT_TRUE(shard.is_complete());
        std::ifstream file(fs::path(shard.folder()) / "part_00000.h5", std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        fs::remove_all(folder);
        return bytes;
    };
    std::vector<int> order(40);
    std::iota(order.begin(), order.end(), 0);
    const std::string in_order = sealed(order);
    EXPECT_GT(in_order.size(), 1000u);
    std::swap(order[3], order[7]);
    EXPECT_TRUE(sealed(order) == in_order);
    std::reverse(order.begin(), order.end());  // too far out of order to be written along
    EXPECT_TRUE(sealed(order) == in_order);
}

TEST_F(ShardTest, FindsWhatIsThereWhenItIsOpenedAgain) {
    add({5, 6, 7});
    const Shard shard = open();
    EXPECT_THAT(shard.missing(), ElementsAre(8, 9));
    EXPECT_EQ(shard.tally().samples, 3);
    EXPECT_THAT(shard.remarks(), IsEmpty());
}

TEST_F(ShardTest, IsLockedWhileItIsOpen) {
    const Shard shard = open();
    try {
        open();
        FAIL() << "was opened twice";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("another process is at work"));
    }
    EXPECT_NO_THROW(open(0));
}

TEST_F(ShardTest, SealsWhatWasCompleteWhenItWasKilled) {
    add({5, 6});
    fs::copy_file(in("part_00000.h5"), in("kept"));
    add({7});
    fs::rename(in("journal_00001"), in("journal_00000.other"));
    fs::rename(in("kept"), in("part_00000.h5"));  // killed after sealing, before its journal was removed
    std::ofstream(in("journal_00000")) << "anything";
    const Shard shard = open();
    EXPECT_THAT(shard.missing(), ElementsAre(7, 8, 9));
    EXPECT_FALSE(fs::exists(in("journal_00000")));
}

TEST_F(ShardTest, MakesADamagedSampleAgainAndKeepsItsNeighbour) {
    add({5, 6});
    files::Hdf5File file = files::Hdf5File::edit(in("part_00000.h5").string());
    std::vector<float> cloth = file.read<float>("/samples/cloth").value;
    cloth.back() += 1.0f;
    file.write_rows("/samples/cloth", 1, 1, &cloth[cloth.size() / 2]);
    file.close();
    {
        Shard shard = open();
        EXPECT_THAT(shard.missing(), ElementsAre(6, 7, 8, 9));
        ASSERT_EQ(shard.remarks().size(), 1u);
        EXPECT_THAT(shard.remarks()[0], HasSubstr("pose 106"));
        shard.add(6, sample(6));
    }
    expect_sealed("part_00000.h5", {5, 6});
}

TEST_F(ShardTest, SurvivesAFlippedByteAnywhereInAPart) {
    add({5, 6});
    const std::uintmax_t size = fs::file_size(in("part_00000.h5"));
    fs::copy_file(in("part_00000.h5"), folder_ / "sound.h5");
    for (std::uintmax_t offset = 0; offset < size; offset += size / 97) {
        flip_byte(in("part_00000.h5"), offset);
        {
            Shard shard = open();
            for (const int slot : shard.missing())
                if (slot < 7) shard.add(slot, sample(slot));
        }
        expect_sealed("part_00000.h5", {5, 6});
        fs::copy_file(folder_ / "sound.h5", in("part_00000.h5"), fs::copy_options::overwrite_existing);
    }
}

TEST_F(ShardTest, MakesATruncatedPartAgain) {
    add({5, 6});
    fs::resize_file(in("part_00000.h5"), fs::file_size(in("part_00000.h5")) / 2);
    const Shard shard = open();
    EXPECT_THAT(shard.missing(), ElementsAre(5, 6, 7, 8, 9));
    EXPECT_EQ(shard.remarks().size(), 1u);
}

TEST_F(ShardTest, MakesADamagedRecordOfTheJournalAgain) {
    add({5});
    flip_byte(in("journal_00000"), fs::file_size(in("journal_00000")) - 1);
    Shard shard = open();
    EXPECT_THAT(shard.missing(), ElementsAre(5, 6, 7, 8, 9));
    EXPECT_THAT(shard.remarks(), ElementsAre(HasSubstr("1 samples in")));
}

TEST_F(ShardTest, TriesAgainWhatTheMachineFailed) {
    {
        Shard shard = open();
        shard.add(5, sample(5, simulate::DrapeStatus::crashed));
        shard.add(6, sample(6, simulate::DrapeStatus::not_at_rest));
        shard.add(7, sample(7, simulate::DrapeStatus::out_of_memory));
        EXPECT_EQ(shard.tally().failed_by_reason().size(), 3u);
    }
    fs::create_directory(folder_ / "replay");
    for (const int slot : {5, 6}) std::ofstream(replay_path(folder_.string(), 100 + slot)) << "kept";
    Shard shard = open();
    EXPECT_THAT(shard.missing(), ElementsAre(5, 7, 8, 9));
    EXPECT_EQ(shard.tally().failed.size(), 1u);
    EXPECT_FALSE(fs::exists(replay_path(folder_.string(), 105)));
    EXPECT_TRUE(fs::exists(replay_path(folder_.string(), 106)));
    shard.add(5, sample(5));
    expect_sealed("part_00000.h5", {5, 6});
}

TEST_F(ShardTest, RefusesAPartOfAnotherCorpus) {
    add({5, 6});
    plan_.header.config_hash[0] = 'f';
    EXPECT_THROW(open(), Error);
}

TEST_F(ShardTest, RefusesAJournalOfAnotherCorpus) {
    add({5});
    plan_.header.config_hash[0] = 'f';
    EXPECT_THROW(open(), Error);
}

TEST_F(ShardTest, RefusesThoseOfAnotherVersion) {
    add({5, 6});
    plan_.header.program_version = "9.9.9";
    EXPECT_THROW(open(), Error);
}

TEST_F(ShardTest, TakesOverTheSoundSamplesOfAWholeDataset) {
    const std::string path = (folder_ / "dataset.h5").string();
    files::DatasetWriter writer(path, plan_.header, 10, 4);
    for (int slot = 0; slot < 10; ++slot) writer.write(slot, test::sample_of(plan_.header, slot % 2 ? slot - 1 : slot));
    writer.finish();
    Shard shard(folder_.string(), {0, 1}, plan_, {4, 4});
    shard.adopt(path);  // the odd rows hold another sample
    EXPECT_THAT(shard.missing(), ElementsAre(1, 3, 5, 7, 9));
    plan_.header.config_hash[0] = 'f';
    EXPECT_THROW(shard.adopt(path), Error);
}

TEST_F(ShardTest, ListsTheShardsOfAFolder) {
    for (const char* name : {"shard_00001_of_00002", "shard_00000_of_00002", "shard_2_of_3", "shard_00007_of_00002"})
        fs::create_directory(folder_ / name);
    const std::vector<ShardNumber> shard = shards_in(folder_.string());
    ASSERT_EQ(shard.size(), 2u);
    EXPECT_EQ(shard[0].index, 0);
    EXPECT_EQ(shard[1].index, 1);
    EXPECT_THAT(shards_in((folder_ / "not there").string()), IsEmpty());
}

}  // namespace
}  // namespace toile::generate
