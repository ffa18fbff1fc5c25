#include <gmock/gmock.h>

#include <csignal>
#include <cstdio>
#include <fstream>

#include "files/dataset_file.h"
#include "tests/app/cli_runner.h"

namespace toile::app {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Two poses of a coarse T-shirt: everything the pipeline does, at the smallest size.
const char* const scene = R"([scene]
name = "small"
[body]
[contact]
[bending]
[poses]
count = 2
[garment]
source = "tshirt"
edge_length = 0.05
[image]
size = "auto"
max_error = 0.002
)";

class CliDataset : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        write("scene.toml", scene);
    }
    std::string bytes(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

TEST_F(CliDataset, RunWritesADatasetThatValidatesPicturesAndAReport) {
    const Outcome outcome = run("run scene.toml --out d --set output.look=[1]");
    ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr("2 of 2 accepted"));
    EXPECT_THAT(files(),
                ElementsAre("d", "d/CARD.md", "d/accuracy.h5", "d/accuracy.json", "d/config.toml", "d/dataset.body.h5",
                            "d/dataset.h5", "d/dataset.timing.h5", "d/dataset.xdmf", "d/displacements.png", "d/mu.png",
                            "d/pose_0001.glb", "d/predictions_image.h5", "d/predictions_mean.h5",
                            "d/predictions_nearest.h5", "d/predictions_ridge.h5", "d/report.html", "d/results.csv",
                            "d/results.json", "d/samples.png", "scene.toml"));
    EXPECT_THAT(outcome.out, HasSubstr("d/report.html"));
    EXPECT_THAT(outcome.out, HasSubstr("Best μ of the quasistatic prior"));
    EXPECT_THAT(bytes("d/CARD.md"), HasSubstr("| command | `toile run scene.toml --out d --set 'output.look=[1]'` |"));
    EXPECT_THAT(bytes("d/CARD.md"), HasSubstr("| body | MIT, made by toile's code |"));
    const files::DatasetReader dataset(path("d/dataset.h5"));
    EXPECT_EQ(dataset.sample_count(), 2);
    char a_sample[32];
    std::snprintf(a_sample, sizeof a_sample, "%.1f kB a sample",
                  1e-3 * static_cast<double>(bytes("d/dataset.h5").size()) / 2);
    EXPECT_THAT(outcome.out, HasSubstr(a_sample));
    EXPECT_GT(dataset.read(0).certificate.seconds, 0.0);
    EXPECT_LE((*dataset.header().resampling_error)[0], 0.002);
    EXPECT_EQ(run("validate d/dataset.h5").status, 0);
    EXPECT_EQ(run("config d/config.toml").status, 0) << "the copy of the configuration works from where it lies";

    expect_refused("run scene.toml --out d", "holds a data set already");
    std::string damaged = bytes("d/dataset.h5");
    damaged[damaged.size() / 2] ^= 0x55;
    write("damaged.h5", damaged);
    expect_refused("validate damaged.h5", "damaged.h5");
    write("cut.h5", damaged.substr(0, damaged.size() / 3));
    expect_refused("validate cut.h5", "cut.h5");
}

TEST_F(CliDataset, SamplesMadeAgainAreTheSame) {
    ASSERT_EQ(run("generate scene.toml --out d").status, 0);
    const Outcome same = run("validate d/dataset.h5 --recompute 100%");
    EXPECT_EQ(same.status, 0) << same.err << same.out;
    EXPECT_THAT(same.out, HasSubstr("made again       2 samples"));
    const Outcome one = run("validate dataset.h5 --recompute 1", "cd d;");
    EXPECT_EQ(one.status, 0) << one.err << one.out;
    EXPECT_THAT(one.out, HasSubstr("made again       1 samples"));

    files::Hdf5File file = files::Hdf5File::edit(path("d/dataset.h5"));
    std::vector<std::uint8_t> digest = file.read<std::uint8_t>("/samples/digest", {2, 16}).value;
    digest[16] ^= 1;
    file.write_rows("/samples/digest", 1, 1, &digest[16]);
    file.close();
    const Outcome other = run("validate d/dataset.h5 --recompute 100%");
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.out, HasSubstr("/samples/digest[1]: pose 1 made again is another sample: it is stored accepted"));
    EXPECT_THAT(other.out, Not(HasSubstr("pose 0 made again")));
}

TEST_F(CliDataset, SamplesOfAnotherConfigurationAreNotMadeAgain) {
    ASSERT_EQ(run("generate scene.toml --out d --set poses.count=1").status, 0);
    files::Hdf5File file = files::Hdf5File::edit(path("d/dataset.h5"));
    file.set_attribute("/", "config_hash", std::string(32, '0'));
    file.close();
    expect_refused("validate d/dataset.h5 --recompute 1", "is not what the data set was made from");
    expect_refused("validate d/dataset.h5 --recompute some", "neither a share");
    expect_refused("validate d/dataset.h5 --dataset d/dataset.h5", "only predictions");
}

TEST_F(CliDataset, JobsDoNotChangeAByte) {
    ASSERT_EQ(run("generate scene.toml --out one --jobs 1").status, 0);
    ASSERT_EQ(run("generate scene.toml --out two --jobs 2").status, 0);
    EXPECT_TRUE(bytes("one/dataset.h5") == bytes("two/dataset.h5"));
}

TEST_F(CliDataset, ASampleDependsOnItsNumberAlone) {
    ASSERT_EQ(run("generate scene.toml --out both --set image.size=32").status, 0);
    ASSERT_EQ(
        run("generate scene.toml --out second --set image.size=32 --set poses.number=[1] --set split.test=0").status,
        0);
    const files::SampleRecord a = files::DatasetReader(path("both/dataset.h5")).read(1);
    const files::SampleRecord b = files::DatasetReader(path("second/dataset.h5")).read(0);
    EXPECT_EQ(a.id, b.id);
    EXPECT_TRUE(a.pose == b.pose);
    EXPECT_TRUE(a.cloth == b.cloth);
    EXPECT_TRUE(a.image == b.image);
}

TEST_F(CliDataset, APoseThatFailsIsKeptAndTheRunGoesOn) {
    // the neutral drape stretches the coarse shirt by 3 %, raised arms by 10 %
    const std::string settings = " --set gate.max_stretch=1.06 --set ladder.tries=1";
    const Outcome outcome = run("run scene.toml --out d" + settings);
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("not accepted"));
    EXPECT_THAT(outcome.out, HasSubstr("overstretched"));
    const files::DatasetReader dataset(path("d/dataset.h5"));
    ASSERT_EQ(dataset.sample_count(), 2);
    for (int slot = 0; slot < 2; ++slot) {
        const files::SampleRecord sample = dataset.read(slot);
        const std::string replay = "d/replay/pose_00000" + std::to_string(slot) + ".h5";
        EXPECT_EQ(std::filesystem::exists(path(replay)), sample.status != 0);
        if (sample.status == 0) continue;
        EXPECT_THAT(outcome.out, HasSubstr(replay));
        EXPECT_EQ(sample.certificate.detail->tries, 2);
        EXPECT_EQ(run("validate " + replay).status, 0);
        const Outcome again = run("simulate --replay " + replay + " --out again.obj");
        EXPECT_EQ(again.status, 3) << again.err;
        EXPECT_THAT(again.out, HasSubstr("certificate, cloth to the last bit")) << again.out;
        expect_refused("simulate scene.toml --out again.obj --replay " + replay, "--replay");
    }
}

TEST_F(CliDataset, AFullDiskLeavesNothing) {
    expect_refused("generate scene.toml --out d", "", "ulimit -f 40;");
}

TEST_F(CliDataset, AnInterruptLosesNothingThatWasMade) {
    ASSERT_EQ(run("generate scene.toml --out whole").status, 0);
    const Outcome outcome = run("generate scene.toml --out d", "timeout --signal=INT 2");
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("toile: interrupted"), HasSubstr("draping 2/2")));
    ASSERT_EQ(run("generate scene.toml --out d --resume").status, 0);
    EXPECT_TRUE(bytes("whole/dataset.h5") == bytes("d/dataset.h5"));
    EXPECT_THAT(files(), Not(Contains(HasSubstr("shard_"))));
}

TEST_F(CliDataset, ShardsHoldTheSamplesOfASingleRun) {
    ASSERT_EQ(run("generate scene.toml --out whole").status, 0);
    ASSERT_EQ(run("generate scene.toml --out d --shard 1/2").status, 0);
    expect_refused("generate scene.toml --out d --shard 1/2", "was begun already");
    expect_refused("generate scene.toml --out d --shard 0/3", "2 shards");
    expect_refused("generate scene.toml --out d", "unfinished work");
    expect_refused("generate scene.toml --out d --shard 0/2 --set scene.seed=5", "another configuration");
    expect_refused("generate scene.toml --out d --shard 2/2", "0 to N - 1");
    expect_refused("generate scene.toml --out d --shard half", "I/N");
    ASSERT_EQ(run("generate scene.toml --out d --shard 0/2 --resume").status, 0) << "also where nothing is";
    const files::DatasetReader whole(path("whole/dataset.h5"));
    for (int slot = 0; slot < 2; ++slot) {
        const files::DatasetReader part(path("d/shard_0000" + std::to_string(slot) + "_of_00002/part_00000.h5"));
        EXPECT_EQ(part.stored_digest(0), whole.stored_digest(slot));
        EXPECT_EQ(files::sample_digest(part.read(0)), files::sample_digest(whole.read(slot)));
        EXPECT_EQ(part.part()->first_slot, slot);
    }
    ASSERT_EQ(run("generate scene.toml --out d --resume").status, 0) << "joins what is complete";
    EXPECT_EQ(run("validate d/dataset.h5").status, 0);
    EXPECT_EQ(run("merge d").status, 0);
    EXPECT_EQ(run("validate d/dataset.h5").status, 0) << "what refers to the shards";
    EXPECT_EQ(run("merge d --copy").status, 0);
    EXPECT_TRUE(bytes("d/dataset.h5") == bytes("whole/dataset.h5"));
    EXPECT_THAT(run("status d").out, HasSubstr("2: 2 finished"));
}

TEST_F(CliDataset, ADamagedSampleOfAFinishedDatasetIsMadeAgain) {
    ASSERT_EQ(run("generate scene.toml --out d").status, 0);
    const std::string whole = bytes("d/dataset.h5");
    files::Hdf5File file = files::Hdf5File::edit(path("d/dataset.h5"));
    std::vector<float> cloth = file.read<float>("/samples/cloth").value;
    cloth[0] += 1e-3f;
    file.write_rows("/samples/cloth", 0, 1, cloth.data());
    file.close();
    EXPECT_THAT(run("validate d/dataset.h5").out, HasSubstr("/samples/digest[0]"));
    const Outcome outcome = run("generate scene.toml --out d --resume");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("pose 0 in"));
    EXPECT_TRUE(bytes("d/dataset.h5") == whole);
}

}  // namespace
}  // namespace toile::app
