#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/app/cli_runner.h"

namespace toile::app {
namespace {

using ::testing::HasSubstr;

class CliStrain : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        write("rest.obj", square(1));
        write("a.obj", square(1.25));
        std::filesystem::create_directories(path("frames"));
        for (int k = 0; k < 6; ++k) write("frames/f" + std::to_string(k) + ".obj", square(1 + 0.1 * k));
    }
    /// A unit square of two triangles, `width` times as wide.
    static std::string square(double width) {
        std::ostringstream text;
        text << "v 0 0 0\nv " << width << " 0 0\nv " << width << " 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
        return text.str();
    }
    std::string bytes_of(const std::string& name) const {
        std::ostringstream bytes;
        bytes << std::ifstream(path(name), std::ios::binary).rdbuf();
        return bytes.str();
    }
};

TEST_F(CliStrain, ExplainsItself) {
    const Outcome outcome = run("evaluate strain --help");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, HasSubstr("  toile evaluate strain --rest"));
}

TEST_F(CliStrain, MeasuresAPairAndColoursIt) {
    const Outcome outcome = run("evaluate strain --rest rest.obj --deformed a.obj --out d --look 1");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* name : {"d/strain.h5", "d/strain.json", "d/strain_0000.ply"}) {
        EXPECT_THAT(outcome.out, HasSubstr(name));
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    }
    EXPECT_THAT(outcome.out, HasSubstr("1.25"));
    EXPECT_THAT(outcome.out, HasSubstr("no rates: they need a sequence with --time-step"));
}

TEST_F(CliStrain, MeasuresASequenceWithItsRates) {
    const std::string what =
        "evaluate strain --sequence 'frames/*.obj' --rest rest.obj --time-step 0.1 --rates "
        "--neighbourhood nearest:3 --look 2 --look-format glb";
    const Outcome outcome = run(what + " --jobs 1 --out d");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("triangle/rate_1"));
    EXPECT_THAT(outcome.out, HasSubstr("d/strain_0005.glb"));
    EXPECT_EQ(run(what + " --jobs 3 --out e").status, 0);
    EXPECT_EQ(bytes_of("d/strain.h5"), bytes_of("e/strain.h5"));
    // Files named one by one, and without a rest state.
    EXPECT_EQ(run("evaluate strain --sequence frames/f0.obj frames/f1.obj --out f").status, 0);
}

TEST_F(CliStrain, RefusesInputAtFault) {
    expect_refused("evaluate strain --rest rest.obj --deformed a.obj", "--out");
    expect_refused("evaluate strain --out d", "meshes or a data set");
    expect_refused("evaluate strain --deformed a.obj --out d", "--rest");
    expect_refused("evaluate strain --rest rest.obj --deformed absent.obj --out d", "absent.obj");
    expect_refused("evaluate strain --rest absent.h5 --deformed a.obj --out d", "absent.h5");
    expect_refused("evaluate strain --rest rest.obj --deformed a.obj --sequence frames --out d", "--sequence");
    expect_refused("evaluate strain --sequence frames --rates --out d", "--time-step");
    for (const char* step : {"0", "-1", "nan", "inf", "soon"})
        expect_refused(std::string("evaluate strain --sequence frames --time-step ") + step + " --out d", "time-step");
    for (const char* rule : {"radius:0", "radius:-1", "radius:nan", "ring:0", "sphere:1"})
        expect_refused(std::string("evaluate strain --rest rest.obj --deformed a.obj --out d --neighbourhood ") + rule,
                       rule);
    expect_refused("evaluate strain --rest rest.obj --deformed a.obj --out d --normal-weight -1", "--normal-weight");
    write("frames/f3.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_refused("evaluate strain --sequence frames --out d", "f3.obj");
    write("frames/f3.obj", "v 0 0 0\nv 1 0 0\nv 1 1 nan\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    expect_refused("evaluate strain --sequence frames --out d", "f3.obj:3");
    std::filesystem::create_directories(path("empty"));
    expect_refused("evaluate strain --sequence empty --out d", "empty");
    expect_refused("evaluate strain --dataset rest.obj --out d", "rest.obj");
    expect_refused("evaluate strain --rest rest.obj --deformed a.obj --out rest.obj", "in the way");
}

}  // namespace
}  // namespace toile::app
