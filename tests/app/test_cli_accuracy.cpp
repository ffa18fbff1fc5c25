#include <gmock/gmock.h>

#include <filesystem>
#include <limits>

#include "files/hdf5_file.h"
#include "files/noise_file.h"
#include "tests/app/cli_runner.h"
#include "tests/evaluate/judged_dataset.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::app {
namespace {

using evaluate::TestPredictions;
using ::testing::HasSubstr;

/// Few settings, so that a run takes no second.
const std::string quick = " --limit 0 --mu 1 --learn-mu none --out out";

class CliAccuracy : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        evaluate::write_bodiless_dataset(path("dataset.h5"), 12);
    }
    void predict(const TestPredictions& predictions = {}) const {
        predictions.write(path("predictions.h5"), path("dataset.h5"));
    }
    std::string command(const std::string& more = {}) const {
        return "evaluate accuracy --dataset dataset.h5 --predictions predictions.h5" + quick + more;
    }
};

TEST_F(CliAccuracy, PrintsATableForEachSplit) {
    predict();
    const Outcome outcome = run(command(" --jobs 2"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* word : {"out/accuracy.json", "out/accuracy.h5", "train: 8 samples", "validation: 2 samples",
                             "test: 2 samples", "shaken", "inextensibility@limit=0", "quasistatic@mu=1",
                             "too few samples to tell", "simulator's noise is not known"})
        EXPECT_THAT(outcome.out, HasSubstr(word));
    EXPECT_TRUE(std::filesystem::exists(path("out/accuracy.json")));
}

TEST_F(CliAccuracy, ListsWhatCouldNotBeSolved) {
    TestPredictions far;
    far.change = [](auto&, std::vector<float>& predicted) {
        for (size_t k = 0; k < 90; ++k) predicted[k] *= 1e36f;
    };
    predict(far);
    const Outcome outcome = run(command());
    EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("toile: sample 50 "));
    EXPECT_TRUE(std::filesystem::exists(path("out/accuracy.json")));
}

TEST_F(CliAccuracy, RefusesWrongPredictions) {
    const auto refused = [&](auto change, const std::string& expected) {
        TestPredictions wrong;
        wrong.change = change;
        predict(wrong);
        expect_refused(command(), expected);
    };
    refused([](auto& id, auto&) { id[3] = 999; }, "999");
    refused([](auto& id, auto& predicted) { predicted.resize(predicted.size() - 3 * id.size()); }, "vertices");
    refused([](auto&, auto& predicted) { predicted[200] = std::numeric_limits<float>::quiet_NaN(); }, "finite");
    refused(
        [](auto& id, auto& predicted) {
            predicted.resize(predicted.size() / id.size() * (id.size() - 1));
            id.pop_back();
        },
        "predict");
    refused(
        [](auto& id, auto& predicted) {
            id.clear();
            predicted.clear();
        },
        "predictions.h5");
    write("predictions.h5", "no HDF5");
    expect_refused(command(), "predictions.h5");
}

TEST_F(CliAccuracy, RefusesADataSetWithoutTruth) {
    predict();
    write("garbage.h5", "no HDF5");
    expect_refused("evaluate accuracy --dataset garbage.h5 --predictions predictions.h5" + quick, "garbage.h5");
    expect_refused("evaluate accuracy --dataset predictions.h5 --predictions predictions.h5" + quick, "predictions.h5");
    generate::TinyDataset tiny;
    tiny.change_sample = [](int, files::SampleRecord& sample) { sample.status = 1; };
    tiny.write(path("dataset.h5"));
    predict();
    expect_refused(command(), "no accepted sample");
    tiny.change_sample = [](int slot, files::SampleRecord& sample) { sample.status = slot == 3; };
    tiny.write(path("dataset.h5"));
    predict();
    expect_refused(command(" --split test"), "test");
    evaluate::write_bodiless_dataset(path("dataset.h5"), 0);
    expect_refused(command(), "empty");
}

TEST_F(CliAccuracy, RefusesTheNoiseOfAnotherMesh) {
    predict();
    generate::TinyDataset().write(path("other.h5"));
    files::NoiseHeader header;
    header.mesh = files::DatasetReader(path("other.h5")).header().mesh;
    header.reasons = {"accepted"};
    header.variant = {{"half_step", "half the step"}};
    files::NoiseWriter writer(path("noise.h5"), header, 0);
    writer.finish();
    expect_refused(command(" --noise noise.h5"), "another mesh");
    expect_refused(command(" --noise absent.h5"), "absent.h5");
}

TEST_F(CliAccuracy, RefusesWhatItCannotWriteTo) {
    predict();
    write("file", "in the way");
    expect_refused("evaluate accuracy --dataset dataset.h5 --predictions predictions.h5 --out file", "file");
    expect_refused(command(" --split nowhere"), "--split");
    expect_refused(command(" --mu -1"), "--mu");
    expect_refused(command(" --limit x"), "--limit");
}

}  // namespace
}  // namespace toile::app
