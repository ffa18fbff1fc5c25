#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "cloth/error.h"
#include "files/motion_file.h"

namespace toile::files {
namespace {

const std::string hierarchy = R"(HIERARCHY
ROOT Hips
{
	OFFSET 0 0 0
	CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation 
	JOINT Left Leg
	{
		OFFSET 1 -2 .5
		CHANNELS 3 ORDER
		End Site
		{
			OFFSET 0 -3 0
		}
	}
	JOINT Spine
	{
		OFFSET 0 1.5 0
		CHANNELS 6 Zposition Xposition Yposition ORDER
		JOINT Head
		{
			OFFSET 0 2 0
			CHANNELS 1 Yrotation
			End Site
			{
				OFFSET 0 1 0
			}
		}
	}
}
)";
const std::string frames =
    "MOTION\nFrames: 2\nFrame Time: .025\n"
    "1 2 3 0 0 0  0 0 0  7 7 7 0 0 0  0\n"
    " 4 5 6 10 20 30  40 -50 60  7 7 7 -70 80 190  25 \r\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

std::string valid(const std::string& order = "Zrotation Xrotation Yrotation") {
    return replaced(hierarchy, "ORDER", order) + frames;
}

class MotionFile : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(path_); }

    Motion read(const std::string& text) {
        std::ofstream(path_, std::ios::binary) << text;
        return read_motion(path_);
    }

    /// What and where of the error, or nothing.
    std::string error(const std::string& text) {
        try {
            read(text);
        } catch (const Error& e) {
            EXPECT_EQ(e.where().rfind(path_, 0), 0u) << e.where();
            return e.what() + (" (" + e.where().substr(path_.size()) + ")");
        }
        return {};
    }

    std::string path_ =
        testing::TempDir() + "toile_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".bvh";
};

/// A rotation by its definition: the channels' axis rotations, in the order of the file, from left to right.
Eigen::Quaterniond composed(const std::string& order, const Eigen::Vector3d& degrees) {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    for (int i = 0; i < 3; ++i)
        q = q * Eigen::AngleAxisd(degrees[i] * M_PI / 180, Eigen::Vector3d::Unit(order[i] - 'X'));
    return q;
}

TEST_F(MotionFile, ReadsSkeletonAndFrames) {
    const Motion motion = read(valid());
    ASSERT_EQ(motion.joint_name, (std::vector<std::string>{"Hips", "Left_Leg", "Spine", "Head"}));
    EXPECT_EQ(motion.joint_parent, (std::vector<int>{-1, 0, 0, 2}));
    EXPECT_EQ(motion.frame_count, 2);
    EXPECT_DOUBLE_EQ(motion.frame_time, 0.025);
    EXPECT_TRUE(motion.rest_offset.row(1).isApprox(Eigen::RowVector3d(1, -2, 0.5)));
    EXPECT_TRUE(motion.end_offset.row(1).isApprox(Eigen::RowVector3d(0, -3, 0)));
    EXPECT_TRUE(motion.end_offset.row(2).isZero());
    EXPECT_TRUE(rest_positions(motion).row(3).isApprox(Eigen::RowVector3d(0, 3.5, 0)));
    EXPECT_TRUE(motion.root_translation.row(1).isApprox(Eigen::RowVector3d(4, 5, 6)));
    EXPECT_LT(motion.local_rotation(0, 2).angularDistance(Eigen::Quaterniond::Identity()), 1e-6);
    EXPECT_LT(motion.local_rotation(1, 0).angularDistance(composed("ZYX", {10, 20, 30})), 2e-6);
}

TEST_F(MotionFile, ComposesEveryChannelOrder) {
    for (const std::string order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}) {
        std::string channels;
        for (const char axis : order) channels += std::string(1, axis) + "rotation ";
        const Motion motion = read(valid(channels));
        EXPECT_LT(motion.local_rotation(1, 1).angularDistance(composed(order, {40, -50, 60})), 2e-6) << order;
        EXPECT_LT(motion.local_rotation(1, 2).angularDistance(composed(order, {-70, 80, 190})), 2e-6) << order;
        EXPECT_LT(motion.local_rotation(1, 3).angularDistance(composed("YYY", {25, 0, 0})), 2e-6) << order;
    }
}

TEST_F(MotionFile, IgnoresWholeFramesBeyondThoseAnnounced) {
    EXPECT_EQ(read(replaced(valid(), "Frames: 2", "Frames: 1")).frame_count, 1);
}

TEST_F(MotionFile, RefusesFilesThatAreNone) {
    try {
        read_motion("/nowhere/at_all.bvh");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.where(), "/nowhere/at_all.bvh");
    }
    EXPECT_THROW(read_motion(testing::TempDir()), Error);
    EXPECT_THAT(error(""), testing::HasSubstr("empty"));
    EXPECT_THAT(error("\n \n"), testing::HasSubstr("empty"));
    EXPECT_THAT(error(std::string("\x7f"
                                  "ELF\0\1\2\3",
                                  8)),
                testing::HasSubstr("HIERARCHY"));
}

TEST_F(MotionFile, RefusesOneDefectAtATime) {
    struct Defect {
        std::string from, to, message;
    };
    const std::vector<Defect> defects = {
        {"Frames: 2", "Frames: 0", "no frame (:31)"},
        {"Frames: 2", "Frames: 3", "announces 3 frames of 16 values, but ends within frame 2"},
        {"Frames: 2", "Frames: 4000000000", "whole number"},
        {"Frames: 2", "Frames: -2", "whole number"},
        {"Frames: 2", "Frames: many", "should be a number, but is 'many' (:31)"},
        {"Frame Time: .025", "Frame Time: nan", "frame time should be a number"},
        {"Frame Time: .025", "Frame Time: -1", "negative"},
        {"40 -50 60", "40 nan 60", "but is 'nan' (:34)"},
        {"40 -50 60", "40 inf 60", "but is 'inf' (:34)"},
        {"40 -50 60", "40 60", "ends within frame 1"},
        {"40 -50 60", "40 -50 1 60", "holds 33 values"},
        {"CHANNELS 1 Yrotation", "CHANNELS 4000000000 Yrotation", "number of channels"},
        {"CHANNELS 1 Yrotation", "CHANNELS 1 Wrotation", "'Wrotation'"},
        {"CHANNELS 1 Yrotation", "CHANNELS 2 Yrotation Yrotation", "twice"},
        {"OFFSET 0 2 0", "OFFSET 0 2", "an offset should be a number, but is 'CHANNELS'"},
        {"OFFSET 0 2 0", "OFFSET 0 nan 0", "'nan' (:21)"},
        {"OFFSET 0 2 0", "", "without an OFFSET"},
        {"JOINT Spine", "JIONT Spine", "'JIONT'"},
        {"JOINT Spine", "JOINT\n\t{", "without a name"},
        {"End Site", "End Sit", "'Site' should stand here"},
        {"MOTION", "", "'MOTION' should stand here"},
        {"MOTION", "}\nMOTION", "'MOTION' should stand here, not '}'"},
    };
    ASSERT_EQ(error(valid()), "");
    for (const Defect& defect : defects)
        EXPECT_THAT(error(replaced(valid(), defect.from, defect.to)), testing::HasSubstr(defect.message))
            << defect.from << " -> " << defect.to;
}

TEST_F(MotionFile, RefusesWhatAssimpDoesNotSurvive) {
    // Channels after a child, where assimp writes through a dangling reference.
    EXPECT_THAT(error("HIERARCHY ROOT a { OFFSET 0 0 0 JOINT b { OFFSET 0 0 0 CHANNELS 1 Xrotation } "
                      "CHANNELS 1 Xrotation } MOTION Frames: 1 Frame Time: 1 0 0"),
                testing::HasSubstr("before a joint's children"));
    std::string deep = "HIERARCHY ROOT a\n{ OFFSET 0 0 0 CHANNELS 1 Xrotation ";
    for (int i = 0; i < 100000; ++i) deep += "JOINT a\n{ OFFSET 0 0 0 CHANNELS 1 Xrotation ";
    EXPECT_THAT(error(deep), testing::HasSubstr("too deep"));
}

TEST_F(MotionFile, SurvivesTruncationAndNoise) {
    const std::string text = valid();
    const std::size_t body = text.find("0  25");
    for (std::size_t length = 1; length < body; length += 7) EXPECT_NE(error(text.substr(0, length)), "") << length;
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < 200; ++i) {
        std::string noisy = text;
        for (int k = 0; k < 3; ++k) noisy[random() % noisy.size()] = static_cast<char>(random() % 256);
        refused += !error(noisy).empty();
    }
    EXPECT_GT(refused, 100);
}

TEST(MotionFileOnRealData, ReadsEveryMotion) {
    const std::filesystem::path folder = std::filesystem::path(TOILE_SHARED_DATA) / "motions";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data at " << folder;
    const Motion cmu = read_motion(folder / "cmu_01_01.bvh");
    EXPECT_EQ(cmu.joint_count(), 31);
    EXPECT_EQ(cmu.frame_count, 2752);
    EXPECT_EQ(read_motion(folder / "wave_hello.bvh").frame_count, 839);
    EXPECT_EQ(read_motion(folder / "tpose.bvh").joint_count(), 173);
    EXPECT_EQ(read_motion(folder / "walk1.bvh").joint_count(), 75);
}

}  // namespace
}  // namespace toile::files
