#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "skin/anatomy.h"
#include "skin/pose_table.h"
#include "tests/skin/stick_body.h"

namespace toile::skin {
namespace {

class PoseTable : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(path_); }

    PoseList read(const std::string& text) {
        std::ofstream(path_, std::ios::binary) << text;
        return read_pose_table(body_, path_);
    }
    std::string error(const std::string& text) {
        try {
            read(text);
        } catch (const Error& e) {
            return e.what() + (" (" + e.where().substr(std::min(path_.size(), e.where().size())) + ")");
        }
        return {};
    }
    int joint(Role role) const { return body_.role[role]; }

    Body body_ = testing_support::stick_body();
    std::string path_ =
        testing::TempDir() + "toile_pose_table_" + testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(PoseTable, TakesJointsByNameAndByRole) {
    body_.joint[joint(Role::left_hand)].name = "hand.01.L";
    const PoseList poses = read("hand.01.L.y,right_lower_arm.x,calf_r.z\n0.1,0.2,0.3\n0,0,-1\n");
    ASSERT_EQ(poses.count(), 2);
    Pose expected = Pose::Zero(body_.joint_count(), 3);
    expected(joint(Role::left_hand), 1) = 0.1;
    expected(joint(Role::right_lower_arm), 0) = 0.2;
    expected(joint(Role::right_lower_leg), 2) = 0.3;
    EXPECT_EQ(poses.pose(0), expected);
    EXPECT_EQ(poses.pose(1)(joint(Role::right_lower_leg), 2), -1);
}

TEST_F(PoseTable, TakesAnatomicalAngles) {
    const PoseList poses = read("left_upper_arm.raise,spine.swing,head.x\n0.4,0.2,0.1\n");
    RoleAngles angles;
    angles.angle[Role::left_upper_arm] = bind_angles(body_, Role::left_upper_arm);
    angles.angle[Role::left_upper_arm][0] = 0.4;
    angles.angle[Role::spine] = {0, 0.2, 0};
    Pose expected = pose_from_angles(body_, angles);
    expected(joint(Role::head), 0) = 0.1;
    EXPECT_EQ(poses.pose(0), expected);
}

TEST_F(PoseTable, FeedsADatasetIntoAnotherRun) {
    const Pose pose = Pose::Random(body_.joint_count(), 3);
    std::vector<std::string> name;
    std::vector<double> bind;
    for (const Joint& joint : body_.joint) {
        name.push_back(joint.name);
        for (int i = 0; i < 16; ++i) bind.push_back(joint.bind(i / 4, i % 4));
    }
    const auto write = [&](bool named) {
        files::Hdf5File file = files::Hdf5File::create(path_);
        file.write("/samples/pose", pose.data(), {1, body_.joint_count(), 3});
        if (named) {
            file.write_strings("/body/joint_name", name);
            file.write("/body/joint_bind", bind, {body_.joint_count(), 4, 4});
        }
        file.close();
    };
    for (const bool named : {false, true}) {
        write(named);
        EXPECT_EQ(read_pose_table(body_, path_).pose(0), pose);
    }
    // The same joints in another body: other axes, another order, one that is absent.
    EXPECT_THROW(read_pose_table(testing_support::stick_body(true), path_), Error);
    std::swap(name.front(), name.back());
    std::swap_ranges(bind.begin(), bind.begin() + 16, bind.end() - 16);
    write(true);
    EXPECT_EQ(read_pose_table(body_, path_).pose(0).row(0), pose.row(pose.rows() - 1));
    body_.joint.back().name = "tail";
    body_.role[Role::right_foot] = -1;
    EXPECT_THROW(read_pose_table(body_, path_), Error);
}

TEST_F(PoseTable, RefusesOneDefectAtATime) {
    ASSERT_EQ(error("spine.x\n0.1\n"), "");
    EXPECT_THAT(error("spine.w\n0.1\n"), testing::HasSubstr("unknown column 'spine.w' (:1)"));
    EXPECT_THAT(error("spine\n0.1\n"), testing::HasSubstr("unknown column 'spine' (:1)"));
    EXPECT_THAT(error("tail.x\n0.1\n"), testing::HasSubstr("no joint for the column 'tail.x' (:1)"));
    EXPECT_THAT(error("tail.raise\n0.1\n"), testing::HasSubstr("'tail.raise'"));
    EXPECT_THAT(error("spine.x,spine.swing\n0,0\n"), testing::HasSubstr("second time"));
    EXPECT_THAT(error("left_foot.x,foot_l.x\n0,0\n"), testing::HasSubstr("second time"));
    EXPECT_THAT(error("spine.x,spine.y\n0.1\n"), testing::HasSubstr("(:2)"));
    body_.role[Role::left_foot] = -1;
    EXPECT_THAT(error("left_foot.raise\n0\n"), testing::HasSubstr("left_foot.raise"));
}

TEST_F(PoseTable, RefusesADatasetOfTheWrongWidth) {
    files::Hdf5File file = files::Hdf5File::create(path_);
    file.write("/samples/pose", std::vector<double>(15, 0.1), {1, 5, 3});
    file.close();
    try {
        read_pose_table(body_, path_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_THAT(e.what(), testing::HasSubstr("15 values a row, but the body's 21 joints need 63"));
        EXPECT_EQ(e.where(), path_ + ":/samples/pose");
    }
}

}  // namespace
}  // namespace toile::skin
