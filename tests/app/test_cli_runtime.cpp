#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/cli_runner.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::app {
namespace {

using ::testing::HasSubstr;

class CliRuntime : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        generate::TinyDataset().write(path("d.h5"));
    }
};

TEST_F(CliRuntime, MeasuresADataSet) {
    const Outcome outcome = run("evaluate runtime --dataset d.h5 --quick --rounds 1 --out out");
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    for (const char* word : {"out/runtime.json", "inextensibility/cone", "quasistatic/newton_cg",
                             "position-based sweeps", "voxel", "left out: the data set's scene cannot be built again"})
        EXPECT_THAT(outcome.out, HasSubstr(word));
    nlohmann::json document;
    std::ifstream(path("out/runtime.json")) >> document;
    EXPECT_EQ(document["kind"], "runtime");
    EXPECT_EQ(document["study"].size(), 7u);
    EXPECT_GT(document["metric"].size(), 50u);
    EXPECT_THAT(document["about"]["command"].get<std::string>(), HasSubstr("evaluate runtime"));
}

TEST_F(CliRuntime, MeasuresSimulatorsAndSizesOfAScene) {
    generate::TinyDataset dataset;
    dataset.change_header = [](files::DatasetHeader& header) {
        header.config =
            "[garment]\nsource = \"patch\"\nwidth = 0.2\nheight = 0.2\nedge_length = 0.05\n[pins]\ncorners = \"top\"\n";
    };
    dataset.write(path("patch.h5"));
    const Outcome outcome = run("evaluate runtime --dataset patch.h5 --quick --studies solvers,mesh --out out");
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    for (const char* word : {"implicit, tolerance", "xpbd, substeps", "Cost exponents", "inextensibility, projection"})
        EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST_F(CliRuntime, RefusesWhatItCannotMeasure) {
    write("garbage.h5", "no HDF5");
    write("file", "in the way");
    expect_refused("evaluate runtime --out d", "--dataset");
    expect_refused("evaluate runtime --dataset d.h5", "--out");
    expect_refused("evaluate runtime --dataset absent.h5 --out d", "absent.h5");
    expect_refused("evaluate runtime --dataset garbage.h5 --out d", "garbage.h5");
    expect_refused("evaluate runtime --dataset d.h5 --out file", "in the way");
    expect_refused("evaluate runtime --dataset d.h5 --out d --studies priors,guesswork", "guesswork");
    expect_refused("evaluate runtime --dataset d.h5 --out d --samples 0", "--samples");
    expect_refused("evaluate runtime --dataset d.h5 --out d --noise 0", "--noise");
    expect_refused("evaluate runtime --dataset d.h5 --out d --predictions garbage.h5", "garbage.h5");
}

}  // namespace
}  // namespace toile::app
