#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "files/replay_file.h"
#include "generate/replay.h"

namespace toile::generate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

files::ReplayRecord triangle_replay(const std::string& reason, int tries) {
    files::ReplayRecord record;
    record.reason = reason;
    record.mesh.triangle.resize(1, 3);
    record.mesh.triangle << 0, 1, 2;
    record.mesh.pattern_triangle = record.mesh.triangle;
    record.mesh.rest_position = Positions::Identity(3, 3);
    record.mesh.pattern_position = record.mesh.rest_position.leftCols<2>();
    record.mesh.mass = Eigen::Vector3d::Ones();
    record.pose = Positions::Zero(2, 3);
    record.start = record.cloth = record.mesh.rest_position;
    record.tries.resize(static_cast<size_t>(tries), {"as configured", reason, {}});
    return record;
}

std::vector<std::string> defects(const files::ReplayRecord& record) {
    const auto path = std::filesystem::temp_directory_path() / ("toile_replay_" + std::to_string(::getpid()) + ".h5");
    files::write_replay(path.string(), record);
    std::vector<std::string> defect = validate_replay(path.string()).defect;
    std::filesystem::remove(path);
    return defect;
}

TEST(Replay, IsValidForADrapeThatFailedAndForOneWhoseProcessDid) {
    EXPECT_THAT(defects(triangle_replay("not_at_rest", 2)), IsEmpty());
    EXPECT_THAT(defects(triangle_replay("crashed", 0)), IsEmpty());
    EXPECT_THAT(defects(triangle_replay("out_of_memory", 0)), IsEmpty());
}

TEST(Replay, HasTheTriesOfItsDrapeAndAKnownReason) {
    EXPECT_THAT(defects(triangle_replay("not_at_rest", 0)), ElementsAre(HasSubstr("/replay/rung: there are none")));
    EXPECT_THAT(defects(triangle_replay("accepted", 1)), ElementsAre(HasSubstr("not one a drape fails for")));
    EXPECT_THAT(defects(triangle_replay("tired", 1)), ElementsAre(HasSubstr("\"tired\"")));
}

}  // namespace
}  // namespace toile::generate
