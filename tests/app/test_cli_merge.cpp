#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "files/dataset_file.h"
#include "tests/app/cli_runner.h"
#include "tests/support/one_triangle_dataset.h"
#include "tests/support/sharded_corpus.h"

namespace toile::app {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// Seven accepted samples, poses 100 to 106, in two shards of parts of two, in the folder c.
class CliMerge : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        const files::DatasetHeader header = test::header_of(true, true);
        fs::create_directory(path("single"));
        files::DatasetWriter writer(path("single/dataset.h5"), header, 7, 4);
        for (int slot = 0; slot < 7; ++slot) {
            files::SampleRecord sample = test::sample_of(header, slot);
            sample.status = 0;
            writer.write(slot, sample);
        }
        writer.finish();
        test::write_corpus(path("single/dataset.h5"), path("c"), 2, 2);
    }
    std::string bytes(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

TEST_F(CliMerge, JoinsTheShards) {
    const Outcome referring = run("merge c");
    EXPECT_EQ(referring.status, 0) << referring.err;
    EXPECT_THAT(referring.out, HasSubstr("7 from 4 parts in 2 shards, 7 accepted; they stay in the shards"));
    EXPECT_EQ(files::DatasetReader(path("c/dataset.h5")).read(6).id, 106);
    const Outcome copied = run("merge c --copy");
    EXPECT_EQ(copied.status, 0) << copied.err;
    EXPECT_TRUE(bytes("c/dataset.h5") == bytes("single/dataset.h5"));
    EXPECT_THAT(run("status c").out, HasSubstr("dataset.h5       holds 7 samples"));
}

TEST_F(CliMerge, GapsAndDamageAreListedWithStatus3) {
    fs::remove(test::part_path(path("c"), {0, 2}, 0));
    std::ofstream(test::part_path(path("c"), {1, 2}, 1)) << "torn";
    const Outcome outcome = run("merge c");
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("missing          4 samples, poses 100, 101, 105, 106"));
    EXPECT_THAT(outcome.out, HasSubstr("damaged          shard_00001_of_00002/part_00001.h5: not an HDF5 file"));
    EXPECT_THAT(outcome.out, HasSubstr("toile generate c/config.toml --out c --resume"));
    EXPECT_EQ(files::DatasetReader(path("c/dataset.h5")).sample_count(), 3);
}

TEST_F(CliMerge, ForeignShardsAndOtherFoldersAreRefused) {
    expect_refused("merge none", "no plan.h5");
    expect_refused("merge single", "no plan.h5");
    expect_refused("merge", "DIR");
    test::write_shard(path("single/dataset.h5"), path("c"), {0, 3}, 2);
    expect_refused("merge c", "into 2 and into 3");
    fs::remove_all(fs::path(test::part_path(path("c"), {0, 3}, 0)).parent_path());
    files::DatasetHeader other = test::header_of(true, true);
    other.config_hash = "ffff";
    files::DatasetWriter writer(test::part_path(path("c"), {0, 2}, 0), other, 1, 4, files::CorpusPart{0, 2, 0, 7});
    writer.write(0, test::sample_of(other, 0));
    writer.finish();
    expect_refused("merge c", "belongs to another corpus");
}

TEST_F(CliMerge, AFullDiskLeavesWhatWasThere) {
    ASSERT_EQ(run("merge c").status, 0);
    const std::string before = bytes("c/dataset.h5");
    const Outcome outcome = run("merge c --copy", "ulimit -f 8;");
    EXPECT_THAT(outcome.err, HasSubstr("largest size allowed"));
    EXPECT_NE(outcome.status, 0);
    EXPECT_TRUE(bytes("c/dataset.h5") == before);
    EXPECT_FALSE(fs::exists(path("c/dataset.h5.partial")));
}

TEST_F(CliMerge, StatusOfShardsAndOfAWholeDataSet) {
    std::ofstream(test::part_path(path("c"), {0, 2}, 0) + "/../progress.json").close();
    const Outcome outcome = run("status c");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("0 of 7 done"));
    EXPECT_THAT(outcome.out, HasSubstr("2: 0 finished, 0 running, 2 stopped, 0 stale, 0 not begun"));
    EXPECT_THAT(outcome.out, HasSubstr("--shard 1/2 --resume"));
    const Outcome whole = run("status single");
    EXPECT_EQ(whole.status, 0) << whole.err;
    EXPECT_THAT(whole.out, HasSubstr("7 of 7 done (100.0 %), 7 accepted"));
    EXPECT_THAT(whole.out, Not(HasSubstr("time left")));
    EXPECT_THAT(run("status single --json").out, HasSubstr("\"done\": 7"));
    expect_refused("status none", "no corpus in this folder");
}

}  // namespace
}  // namespace toile::app
