#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/app/cli_runner.h"

namespace toile::app {
namespace {

using ::testing::HasSubstr;

const char* const patch_scene =
    "[garment]\nsource = \"patch\"\nwidth = 0.2\nheight = 0.2\nedge_length = 0.05\n[pins]\ncorners = \"top\"\n";

class CliEvaluate : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        write("patch.toml", patch_scene);
    }
    std::string bytes_of(const std::string& name) const {
        std::ostringstream bytes;
        bytes << std::ifstream(path(name), std::ios::binary).rdbuf();
        return bytes.str();
    }
};

TEST_F(CliEvaluate, ExplainsItself) {
    for (const char* command : {"evaluate", "evaluate noise", "evaluate stability"}) {
        const Outcome outcome = run(std::string(command) + " --help");
        EXPECT_EQ(outcome.status, 0) << command;
        EXPECT_THAT(outcome.out, HasSubstr(std::string("  toile ") + command)) << "an example of its use";
    }
}

TEST_F(CliEvaluate, MeasuresTheNoiseOfAScene) {
    const Outcome outcome = run("evaluate noise patch.toml --out noise --jobs 1");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* word : {"noise/noise.h5", "noise/noise.json", "half_step", "fine_tolerance", "spread"})
        EXPECT_THAT(outcome.out, HasSubstr(word));
    EXPECT_TRUE(std::filesystem::exists(path("noise/noise.h5")));
    EXPECT_EQ(run("evaluate noise patch.toml --out again --jobs 2").status, 0);
    EXPECT_EQ(bytes_of("noise/noise.h5"), bytes_of("again/noise.h5"));
}

TEST_F(CliEvaluate, TriesAnExtreme) {
    const Outcome outcome = run("evaluate stability --out stable --solver implicit --filter 'friction 2, on a table'");
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("implicit: 1 of 1 cases passed"));
    for (const char* name : {"stable/stability.csv", "stable/stability.json", "stable/stability.png"})
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    const Outcome more =
        run("evaluate stability --out stable --solver implicit --filter 'friction 0, on a table' --tries 0 --resume");
    EXPECT_EQ(more.status, 0) << more.out << more.err;
    EXPECT_THAT(more.out, HasSubstr("implicit: 2 of 2 cases passed"));
}

TEST_F(CliEvaluate, RunsAFailedCaseAgain) {
    const std::string suite = "evaluate stability --out stable --solver implicit --filter 'friction 2, on a table'";
    const Outcome failed = run(suite + " --iterations 1 --tries 0");
    EXPECT_EQ(failed.status, 3) << failed.out << failed.err;
    const std::string replay = "stable/stability_replay/implicit_friction_2_on_a_table.h5";
    const Outcome again = run("simulate --replay " + replay + " --out cloth.obj");
    EXPECT_EQ(again.status, 3) << again.err;
    EXPECT_THAT(again.out, HasSubstr("cloth to the last bit"));
    EXPECT_THAT(again.out, HasSubstr("friction 2, on a table"));
    const Outcome mended =
        run("simulate --replay " + replay + " --out cloth.obj --set case.max_iterations=5000 --set case.tries=3");
    EXPECT_EQ(mended.status, 0) << mended.out << mended.err;
    expect_refused("simulate --replay " + replay + " --out cloth.obj --set case.solver=guesswork", "guesswork");
}

TEST_F(CliEvaluate, TriesPriors) {
    const Outcome outcome = run("evaluate stability --out priors --solver inextensibility --quick --problems 6");
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("inextensibility/interior_point: "));
    EXPECT_THAT(outcome.out, HasSubstr("inextensibility/cone: "));
    EXPECT_FALSE(std::filesystem::exists(path("priors/stability.png"))) << "a picture of drapes";
}

TEST_F(CliEvaluate, RefusesWhatItCannotMeasure) {
    write("garbage.h5", "no HDF5");
    write("file", "in the way");
    expect_refused("evaluate", "subcommand");
    expect_refused("evaluate noise patch.toml", "--out");
    expect_refused("evaluate noise absent.toml --out d", "absent.toml");
    expect_refused("evaluate noise garbage.h5 --out d", "garbage.h5");
    expect_refused("evaluate noise patch.toml --out d --share 0", "--share");
    expect_refused("evaluate noise patch.toml --out d --share 1.1", "--share");
    expect_refused("evaluate noise patch.toml --out file", "in the way");
    expect_refused("evaluate stability --out d --solver guesswork", "guesswork");
    expect_refused("evaluate stability --out d --filter nosuchcase", "nosuchcase");
    expect_refused("evaluate stability --out file --quick", "in the way");
    expect_refused("evaluate stability --out d --quick --tries 9", "--tries");
    std::filesystem::create_directories(path("broken"));
    write("broken/stability.json", "{}");
    expect_refused("evaluate stability --out broken --quick --resume", "stability.json");
}

}  // namespace
}  // namespace toile::app
