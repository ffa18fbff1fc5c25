#include <gmock/gmock.h>

#include "tests/app/cli_runner.h"

namespace toile::app {
namespace {

using ::testing::HasSubstr;

const char* const patch_scene =
    "[garment]\nsource = \"patch\"\nwidth = 0.2\nheight = 0.2\nedge_length = 0.05\n[pins]\ncorners = \"top\"\n";
const char* const body_scene =
    "[body]\nvoxel = 0.03\n[contact]\n[poses]\ncount = 2\n[garment]\nsource = \"tshirt\"\nedge_length = 0.05\n";

class Cli : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        write("patch.toml", patch_scene);
        write("body.toml", body_scene);
    }
};

TEST_F(Cli, ExplainsItself) {
    for (const char* command : {"run", "generate", "skin", "simulate", "validate", "config"}) {
        const Outcome outcome = run(std::string(command) + " --help");
        EXPECT_EQ(outcome.status, 0) << command;
        EXPECT_THAT(outcome.out, HasSubstr(std::string("  toile ") + command)) << "an example of its use";
        EXPECT_EQ(outcome.err, "");
    }
    EXPECT_EQ(run("--help").status, 0);
    EXPECT_THAT(run("--version").out, HasSubstr("toile 0."));
}

TEST_F(Cli, PrintsAConfigurationThatItReadsBack) {
    const Outcome first = run("config body.toml --set body.height=1.8");
    EXPECT_EQ(first.status, 0) << first.err;
    EXPECT_THAT(first.out, HasSubstr("height = 1.8"));
    EXPECT_THAT(first.out, HasSubstr("# no [bending]: no hinges"));
    write("again.toml", first.out);
    EXPECT_EQ(run("config again.toml").out, first.out);
}

TEST_F(Cli, DrapesASceneWithoutABody) {
    for (const char* name : {"patch.obj", "patch.ply", "patch.glb"}) {
        const Outcome outcome = run(std::string("simulate patch.toml --out ") + name);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("accepted"));
        EXPECT_GT(std::filesystem::file_size(path(name)), 500u);
    }
}

TEST_F(Cli, WritesAPosedBody) {
    const Outcome outcome = run("skin body.toml --pose 1 --out body.obj");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_GT(std::filesystem::file_size(path("body.obj")), 100000u);
}

TEST_F(Cli, RefusesBadFlags) {
    expect_refused("", "subcommand");
    expect_refused("drape", "no command drape");
    expect_refused("config", "CONFIG");
    expect_refused("config patch.toml --quick", "--quick");
    expect_refused("config patch.toml --set", "--set");
    expect_refused("simulate patch.toml", "--out");
    expect_refused("simulate --out a.obj", "CONFIG");
    expect_refused("simulate --replay patch.toml --out a.obj", "patch.toml");
    expect_refused("simulate --replay absent.h5 --out a.obj", "absent.h5");
    expect_refused("simulate patch.toml --out a.obj --pose x", "--pose");
    expect_refused("simulate patch.toml --out a.obj --pose -1", "-1");
    expect_refused("generate body.toml --out d --jobs 0", "--jobs");
    expect_refused("generate body.toml --out d --jobs two", "--jobs");
    expect_refused("skin body.toml --out a.obj", "--pose");
}

TEST_F(Cli, RefusesBadConfigurations) {
    write("empty.toml", "");
    write("garbage.toml", std::string("\x89HDF\r\n\x1a\n\0\0\xff\xfe", 13));
    write("truncated.toml", std::string(patch_scene).substr(0, 25));
    write("unknown.toml", std::string(patch_scene) + "[simulate]\ntime_stepp = 0.01\n");
    write("type.toml", std::string(patch_scene) + "[simulate]\ntime_step = \"fast\"\n");
    write("range.toml", std::string(patch_scene) + "[simulate]\ntime_step = -1.0\n");
    write("nan.toml", std::string(patch_scene) + "[simulate]\ngravity = [0.0, nan, 0.0]\n");
    const std::string command = "simulate --out a.obj ";
    expect_refused(command + "absent.toml", "absent.toml");
    expect_refused(command + "empty.toml", "empty");
    expect_refused(command + "garbage.toml", "garbage.toml:1");
    expect_refused(command + "truncated.toml", "truncated.toml:");
    expect_refused(command + ".", "folder");
    expect_refused(command + "unknown.toml", "simulate.time_stepp (unknown.toml:9)");
    expect_refused(command + "type.toml", "0.0001 to 0.2 [s]) (type.toml:9)");
    expect_refused(command + "range.toml", "simulate.time_step is -1.0");
    expect_refused(command + "nan.toml", "nan.toml:9");
    expect_refused(command + "patch.toml --set simulate.solver=guesswork", "(--set simulate.solver)");
    expect_refused(command + "patch.toml --set simulate", "--set");
}

TEST_F(Cli, RefusesTablesThatDoNotGoTogether) {
    expect_refused("config patch.toml --set image={}", "[image] needs [body]");
    expect_refused("config patch.toml --set sphere={}", "[sphere] needs [contact]");
    expect_refused("config patch.toml --set contact={}", "nothing to touch");
    expect_refused("config patch.toml --set garment.source=tshirt", "garment.");
    expect_refused("simulate patch.toml --out a.obj --set pins.vertex=[9999]", "vertex 9999");
    expect_refused("generate patch.toml --out d", "no [body]");
    expect_refused("skin patch.toml --pose 0 --out a.obj", "no [body]");
}

TEST_F(Cli, RefusesPosesThatAreNotThere) {
    expect_refused("skin body.toml --pose 2 --out a.obj", "no pose 2");
    expect_refused("skin body.toml --pose 0 --out a.obj --set poses.limits.left_upper_arm.raise=[1,-1]", "lower limit");
    expect_refused("skin body.toml --pose 0 --out a.obj --set poses.limits.left_wing.raise=[0,1]", "left_wing");
    expect_refused("skin body.toml --pose 0 --out a.obj --set 'poses.roles=[\"tail\"]'", "tail");
}

TEST_F(Cli, RefusesBadFilesOfEveryKind) {
    write("empty", "");
    write("garbage", std::string("\x01\x02\x03 garbage \0\xff", 14));
    for (const char* name : {"absent", "empty", "garbage", "."}) {
        const std::string file = name;
        const std::string pose = "skin body.toml --pose 0 --out a.obj --set poses.file=" + file;
        expect_refused("skin body.toml --pose 0 --out a.obj --set body.source=file --set body.file=" + file, "");
        expect_refused(pose + " --set poses.source=bvh", "");
        expect_refused(pose + " --set poses.source=table", "");
        expect_refused("simulate patch.toml --out a.obj --set garment='{source=\"file\", file=\"" + file + "\"}'", "");
        expect_refused("validate " + file, "");
    }
    write("width.csv", "0.1,0.2,0.3\n0.1,0.2\n");
    expect_refused("skin body.toml --pose 0 --out a.obj --set poses.source=table --set poses.file=width.csv",
                   "width.csv");
}

TEST_F(Cli, RefusesPlacesItCannotWriteTo) {
    write("file", "in the way");
    write("dataset.h5", "a data set from before");
    expect_refused("simulate patch.toml --out nowhere/a.obj", "nowhere");
    expect_refused("simulate patch.toml --out .", "");
    expect_refused("simulate patch.toml --out a.stl", "a.stl");
    expect_refused("simulate patch.toml --out /proc/a.obj", "/proc");
    expect_refused("generate body.toml --out file", "in the way");
    expect_refused("generate body.toml --out file/inside", "file");
    expect_refused("generate body.toml --out .", "holds a data set already");
    expect_refused("generate body.toml --out /proc/toile", "/proc");
}

TEST_F(Cli, LeavesNoHalfFileOnAFullDisk) {
    // a limit of 512 bytes a file stands in for the full disk
    expect_refused("simulate patch.toml --out a.obj", "a.obj", "ulimit -f 1;");
    expect_refused("simulate patch.toml --out a.glb", "a.glb", "ulimit -f 1;");
    const Outcome outcome = run("config patch.toml >/dev/full");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("toile: cannot write the output: No space left"));
}

}  // namespace
}  // namespace toile::app
