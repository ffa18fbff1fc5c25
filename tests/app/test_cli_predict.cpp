#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "files/hdf5_file.h"
#include "tests/app/cli_runner.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::app {
namespace {

using files::Hdf5File;
using ::testing::HasSubstr;

class CliPredict : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        generate::TinyDataset().write(path("d.h5"));
    }
    /// A data set whose samples are changed, as "changed.h5".
    void change(const std::function<void(files::SampleRecord&)>& each) const {
        generate::TinyDataset dataset;
        dataset.change_sample = [&](int, files::SampleRecord& sample) { each(sample); };
        dataset.write(path("changed.h5"));
    }
};

TEST_F(CliPredict, EachPredictorsFileFitsItsDataSet) {
    for (const std::string name : {"ridge", "mean", "nearest", "image"}) {
        const Outcome outcome = run("predict d.h5 --out " + name + ".h5 --predictor " + name);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr(name + ".h5\n" + name + " on "));
        for (const char* split : {"train ", "validation ", "test "}) EXPECT_THAT(outcome.out, HasSubstr(split));
        EXPECT_EQ(Hdf5File::open(path(name + ".h5")).string_attribute("/", "predictor"), name);
        EXPECT_EQ(run("validate " + name + ".h5 --dataset d.h5").status, 0);
    }
    const Outcome plain = run("predict d.h5 --out plain.h5 --jobs 2");
    EXPECT_THAT(plain.out, HasSubstr("components "));
    EXPECT_THAT(plain.out, HasSubstr("explained_variance "));
}

TEST_F(CliPredict, FlagsReachTheFit) {
    const Outcome outcome = run("predict d.h5 --out p.h5 --components 1 --ridge 0.25 --seed 9");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string options = Hdf5File::open(path("p.h5")).string_attribute("/", "options");
    for (const char* line : {"components = 1\n", "ridge = 0.25\n", "seed = 9\n"}) EXPECT_THAT(options, HasSubstr(line));
}

TEST_F(CliPredict, RefusesBadFlags) {
    expect_refused("predict", "DATASET");
    expect_refused("predict d.h5", "--out");
    expect_refused("predict d.h5 --out p.h5 --predictor oracle", "oracle");
    expect_refused("predict d.h5 --out p.h5 --components 0", "--components");
    expect_refused("predict d.h5 --out p.h5 --components 10001", "--components");
    expect_refused("predict d.h5 --out p.h5 --ridge -1", "--ridge");
    expect_refused("predict d.h5 --out p.h5 --ridge nan", "ridge is nan");
    expect_refused("predict d.h5 --out p.h5 --seed x", "--seed");
    expect_refused("predict d.h5 --out p.h5 --jobs 0", "--jobs");
}

TEST_F(CliPredict, RefusesFilesAtFault) {
    expect_refused("predict none.h5 --out p.h5", "none.h5");
    expect_refused("predict d.h5 --out d.h5", "would replace");
    expect_refused("predict d.h5 --out none/p.h5", "none/p.h5");
    write("text.h5", "no HDF5");
    expect_refused("predict text.h5 --out p.h5", "text.h5");
    run("predict d.h5 --out mean.h5 --predictor mean");
    expect_refused("predict mean.h5 --out p.h5", "mean.h5");  // predictions are no data set
    std::filesystem::copy(path("d.h5"), path("cut.h5"));
    std::filesystem::resize_file(path("cut.h5"), std::filesystem::file_size(path("cut.h5")) / 2);
    expect_refused("predict cut.h5 --out p.h5", "cut.h5");
}

TEST_F(CliPredict, RefusesDataSetsThatTeachNothing) {
    change([](files::SampleRecord& sample) { sample.split = 2; });
    expect_refused("predict changed.h5 --out p.h5", "no accepted sample in the train split");
    change([](files::SampleRecord& sample) { sample.status = 1; });
    expect_refused("predict changed.h5 --out p.h5", "none of the data set's 4 samples is accepted");
    change([](files::SampleRecord& sample) { sample.displacement(0, 0) = std::nan(""); });
    expect_refused("predict changed.h5 --out p.h5", "sample 10 is accepted, but not finite");
    generate::TinyDataset without;
    without.change_header = [](files::DatasetHeader& header) { header.image.reset(); };
    without.change_sample = [](int, files::SampleRecord& sample) { sample.image.clear(); };
    without.write(path("plain.h5"));
    EXPECT_EQ(run("predict plain.h5 --out ridge.h5").status, 0);
    expect_refused("predict plain.h5 --out p.h5 --predictor image", "the data set has no images");
}

}  // namespace
}  // namespace toile::app
