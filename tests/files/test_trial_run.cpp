#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <stdexcept>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "files/trial_run.h"
#include "tests/support/rigged_gltf.h"

namespace toile::files {
namespace {

void expect_refused(const std::string& word, const std::function<std::string()>& read) {
    try {
        trial_run("a.fbx", 1, read);
        ADD_FAILURE() << word;
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr(word));
        EXPECT_EQ(error.where(), "a.fbx");
    }
}

TEST(TrialRun, LetsOrdinaryEndsPass) {
    int calls = 0;
    const auto count = [&] {
        ++calls;
        return std::string();
    };
    EXPECT_EQ(trial_run("a.fbx", 5, count), "");
    EXPECT_EQ(calls, 0);  // it happened elsewhere
    EXPECT_EQ(trial_run("a.fbx", 5, [] { return std::string("line 3"); }), "line 3");
    EXPECT_EQ(trial_run("a.fbx", 5, []() -> std::string { throw std::runtime_error("unreadable"); }), "unreadable");
}

TEST(TrialRun, CatchesAbortsAndEndlessLoops) {
    expect_refused("broke down", []() -> std::string { std::abort(); });
    expect_refused("broke down", []() -> std::string { ::_exit(7); });
    expect_refused("does not come to an end", []() -> std::string {
        std::atomic<unsigned> turns{0};
        while (true) ++turns;
    });
}

TEST(TrialRun, KeepsACrashingReaderFromUs) {
    // A polygon that names a vertex far beyond the mesh: assimp's FBX converter asserts.
    const std::string cut =
        "; FBX 7.4.0 project file\nObjects:  {\n Geometry: 1, \"Geometry::\", \"Mesh\" {\n"
        "  Vertices: *9 { a: 0,0,0,1,0,0,0,1,0 }\n  PolygonVertexIndex: *3 { a: 0,1,-99999 }\n }\n}\n";
    EXPECT_THROW(read_mesh(toile::testing_support::write_test_file("bad.fbx", cut)), Error);
}

}  // namespace
}  // namespace toile::files
