#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "tests/app/cli_runner.h"
#include "tests/generate/tiny_dataset.h"

namespace toile::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string read_export = std::string(TOILE_SOURCE_DIR) + "/tests/app/read_export.py";

/// Empty, or why this machine cannot read the exports with Python.
std::string python_lacks() {
    if (std::system("/usr/bin/python3 -c 'import numpy, h5py' > /dev/null 2>&1") == 0) return {};
    return "there is no /usr/bin/python3 with numpy and h5py (Debian: python3-h5py) to read exports";
}

class CliExport : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        generate::TinyDataset().write(path("dataset.h5"));
    }
    void expect_read(const std::string& interpreter, const std::string& format, const std::string& out) const {
        const Outcome outcome = run("export dataset.h5 --format " + format + " --out " + out);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("samples          4")) << outcome.out;
        const std::string command = "cd '" + path("") + "' && " + interpreter + " '" + read_export + "' dataset.h5 " +
                                    format + " " + out + " > read.txt 2>&1";
        const int status = std::system(command.c_str());
        std::ifstream said(path("read.txt"));
        EXPECT_EQ(status, 0) << format << ": " << std::string(std::istreambuf_iterator<char>(said), {});
    }
};

TEST_F(CliExport, NumPyReadsArraysCachesAndMeshes) {
    if (!python_lacks().empty()) GTEST_SKIP() << python_lacks();
    expect_read("/usr/bin/python3", "npz", "a.npz");
    expect_read("/usr/bin/python3", "pc2", "pc2");
    expect_read("/usr/bin/python3", "obj", "obj");
    expect_read("/usr/bin/python3", "ply", "ply");
}

TEST_F(CliExport, ParaViewReadsTheTimeSeries) {
    if (!python_lacks().empty()) GTEST_SKIP() << python_lacks();
    if (std::system("pvpython --version > /dev/null 2>&1") != 0)
        GTEST_SKIP() << "there is no pvpython (Debian: python3-paraview) to read XDMF";
    expect_read("pvpython --force-offscreen-rendering", "xdmf", "a.xdmf");
}

TEST_F(CliExport, BadFlagsAreRefused) {
    const std::string all = "export dataset.h5 --format ";
    expect_refused("export none.h5 --format npz --out a.npz", "none.h5");
    expect_refused(all + "fbx --out a.fbx", "fbx");
    expect_refused(all + "npz --out a.zip", "a.zip");
    expect_refused(all + "npz", "--out");
    expect_refused(all + "npz --out a.npz --pose 3-", "--pose");
    expect_refused(all + "npz --out a.npz --pose 99", "no sample is selected");
    expect_refused(all + "npz --out a.npz --split middle", "middle");
    expect_refused(all + "npz --out a.npz --rate -1", "--rate");
    expect_refused(all + "npz --out a.npz", "largest size", "ulimit -f 1;");
    write("text.h5", "not HDF5");
    expect_refused("export text.h5 --format npz --out a.npz", "text.h5");
}

}  // namespace
}  // namespace toile::app
