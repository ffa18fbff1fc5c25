#include <gtest/gtest.h>

#include <map>

#include "skin/role_names.h"

namespace toile::skin {
namespace {

struct Rig {
    std::vector<NamedJoint> joint;
    std::map<std::string, int> index;

    Rig& chain(const std::string& parent, const std::vector<std::string>& names) {
        int above = parent.empty() ? -1 : index.at(parent);
        for (const std::string& name : names) {
            index[name] = static_cast<int>(joint.size());
            joint.push_back({name, above});
            above = index[name];
        }
        return *this;
    }
};

/// Names of the roles in their order, "" for none.
void expect_roles(const Rig& rig, const std::vector<std::string>& expected, const RoleMap& fixed = {}) {
    const RoleMap roles = detect_roles(rig.joint, fixed);
    ASSERT_EQ(expected.size(), static_cast<size_t>(role_count));
    for (int i = 0; i < role_count; ++i)
        EXPECT_EQ(roles.joint[i] < 0 ? "" : rig.joint[roles.joint[i]].name, expected[i])
            << role_name(static_cast<Role>(i));
}

TEST(DetectRoles, Cmu) {
    Rig rig;
    rig.chain("", {"Hips", "LHipJoint", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"})
        .chain("Hips", {"RHipJoint", "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"})
        .chain("Hips", {"LowerBack", "Spine", "Spine1", "Neck", "Neck1", "Head"})
        .chain("Spine1", {"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "LeftFingerBase", "LeftHandIndex1"})
        .chain("LeftHand", {"LThumb"})
        .chain("Spine1", {"RightShoulder", "RightArm", "RightForeArm", "RightHand", "RightFingerBase"});
    expect_roles(rig, {"Hips", "LowerBack", "Spine1", "Neck", "Head", "LeftShoulder", "LeftArm", "LeftForeArm",
                       "LeftHand", "RightShoulder", "RightArm", "RightForeArm", "RightHand", "LeftUpLeg", "LeftLeg",
                       "LeftFoot", "RightUpLeg", "RightLeg", "RightFoot"});
}

TEST(DetectRoles, MakeHuman) {
    Rig rig;
    rig.chain("", {"root", "spine05", "spine04", "spine03", "spine02", "spine01", "neck01", "neck02", "neck03", "head",
                   "jaw"});
    for (const std::string s : {".L", ".R"})
        rig.chain("spine02", {"breast" + s})
            .chain("spine01", {"clavicle" + s, "shoulder01" + s, "upperarm01" + s, "upperarm02" + s, "lowerarm01" + s,
                               "lowerarm02" + s, "wrist" + s, "metacarpal1" + s, "finger2-1" + s})
            .chain("root", {"pelvis" + s, "upperleg01" + s, "upperleg02" + s, "lowerleg01" + s, "lowerleg02" + s,
                            "foot" + s, "toe1-1" + s});
    expect_roles(rig, {"root", "spine05", "spine01", "neck01", "head", "clavicle.L", "upperarm01.L", "lowerarm01.L",
                       "wrist.L", "clavicle.R", "upperarm01.R", "lowerarm01.R", "wrist.R", "upperleg01.L",
                       "lowerleg01.L", "foot.L", "upperleg01.R", "lowerleg01.R", "foot.R"});
}

TEST(DetectRoles, MixamoWithNumberedPrefix) {
    Rig rig;
    const std::string p = "mixamorig1:";
    rig.chain("", {p + "Hips", p + "Spine", p + "Spine1", p + "Spine2", p + "Neck", p + "Head", p + "HeadTop_End"});
    for (const std::string s : {"Left", "Right"})
        rig.chain(p + "Spine2",
                  {p + s + "Shoulder", p + s + "Arm", p + s + "ForeArm", p + s + "Hand", p + s + "HandThumb1"})
            .chain(p + "Hips", {p + s + "UpLeg", p + s + "Leg", p + s + "Foot", p + s + "ToeBase", p + s + "Toe_End"});
    expect_roles(rig, {p + "Hips", p + "Spine", p + "Spine2", p + "Neck", p + "Head", p + "LeftShoulder", p + "LeftArm",
                       p + "LeftForeArm", p + "LeftHand", p + "RightShoulder", p + "RightArm", p + "RightForeArm",
                       p + "RightHand", p + "LeftUpLeg", p + "LeftLeg", p + "LeftFoot", p + "RightUpLeg",
                       p + "RightLeg", p + "RightFoot"});
}

TEST(DetectRoles, UnrealWithTwistAndInverseKinematics) {
    Rig rig;
    rig.chain("", {"root", "pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"})
        .chain("root", {"ik_foot_root", "ik_foot_l"})
        .chain("root", {"ik_hand_root", "ik_hand_gun", "ik_hand_l"});
    for (const std::string s : {"_l", "_r"})
        rig.chain("spine_03", {"clavicle" + s, "upperarm" + s, "upperarm_twist_01" + s})
            .chain("upperarm" + s, {"lowerarm" + s, "lowerarm_twist_01" + s})
            .chain("lowerarm" + s, {"hand" + s, "index_01" + s})
            .chain("pelvis", {"thigh" + s, "thigh_twist_01" + s})
            .chain("thigh" + s, {"calf" + s, "calf_twist_01" + s})
            .chain("calf" + s, {"foot" + s, "ball" + s});
    expect_roles(rig, {"pelvis", "spine_01", "spine_03", "neck_01", "head", "clavicle_l", "upperarm_l", "lowerarm_l",
                       "hand_l", "clavicle_r", "upperarm_r", "lowerarm_r", "hand_r", "thigh_l", "calf_l", "foot_l",
                       "thigh_r", "calf_r", "foot_r"});
}

TEST(DetectRoles, SmplInBothSpellings) {
    for (const auto& [l, r] : {std::pair<std::string, std::string>{"L_", "R_"}, {"left_", "right_"}}) {
        Rig rig;
        rig.chain("", {"Pelvis", "Spine1", "Spine2", "Spine3", "Neck", "Head"});
        for (const std::string& s : {l, r})
            rig.chain("Pelvis", {s + "Hip", s + "Knee", s + "Ankle", s + "Foot"})
                .chain("Spine3", {s + "Collar", s + "Shoulder", s + "Elbow", s + "Wrist", s + "Hand"});
        expect_roles(rig, {"Pelvis", "Spine1", "Spine3", "Neck", "Head", l + "Collar", l + "Shoulder", l + "Elbow",
                           l + "Wrist", r + "Collar", r + "Shoulder", r + "Elbow", r + "Wrist", l + "Hip", l + "Knee",
                           l + "Ankle", r + "Hip", r + "Knee", r + "Ankle"});
    }
}

TEST(DetectRoles, VrmAndBiped) {
    Rig vrm;
    vrm.chain("", {"Root", "J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_UpperChest", "J_Bip_C_Neck",
                   "J_Bip_C_Head"});
    for (const std::string s : {"J_Bip_L_", "J_Bip_R_"})
        vrm.chain("J_Bip_C_UpperChest", {s + "Shoulder", s + "UpperArm", s + "LowerArm", s + "Hand", s + "Thumb1"})
            .chain("J_Bip_C_Hips", {s + "UpperLeg", s + "LowerLeg", s + "Foot", s + "ToeBase"});
    const std::string l = "J_Bip_L_", r = "J_Bip_R_";
    expect_roles(
        vrm, {"J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_UpperChest", "J_Bip_C_Neck", "J_Bip_C_Head", l + "Shoulder",
              l + "UpperArm", l + "LowerArm", l + "Hand", r + "Shoulder", r + "UpperArm", r + "LowerArm", r + "Hand",
              l + "UpperLeg", l + "LowerLeg", l + "Foot", r + "UpperLeg", r + "LowerLeg", r + "Foot"});
    // In Biped the legs hang on the first spine joint.
    Rig biped;
    biped.chain("", {"Bip01", "Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head"});
    for (const std::string s : {"Bip01 L ", "Bip01 R "})
        biped.chain("Bip01 Neck", {s + "Clavicle", s + "UpperArm", s + "Forearm", s + "Hand", s + "Finger0"})
            .chain("Bip01 Spine", {s + "Thigh", s + "Calf", s + "Foot", s + "Toe0"});
    const RoleMap roles = detect_roles(biped.joint);
    EXPECT_EQ(roles[Role::pelvis], biped.index["Bip01 Pelvis"]);
    EXPECT_EQ(roles[Role::left_upper_arm], biped.index["Bip01 L UpperArm"]);
    EXPECT_EQ(roles[Role::right_foot], biped.index["Bip01 R Foot"]);
    EXPECT_EQ(roles[Role::head], biped.index["Bip01 Head"]);
    EXPECT_EQ(roles[Role::spine], biped.index["Bip01 Spine"]);
}

TEST(DetectRoles, RigifyCountsTheSpineUpToTheHead) {
    Rig rig;
    rig.chain("", {"DEF-spine", "DEF-spine.001", "DEF-spine.002", "DEF-spine.003", "DEF-spine.004", "DEF-spine.005",
                   "DEF-spine.006"});
    for (const std::string s : {".L", ".R"})
        rig.chain("DEF-spine.003", {"DEF-shoulder" + s, "DEF-upper_arm" + s, "DEF-upper_arm" + s + ".001",
                                    "DEF-forearm" + s, "DEF-forearm" + s + ".001", "DEF-hand" + s})
            .chain("DEF-spine", {"DEF-thigh" + s, "DEF-thigh" + s + ".001", "DEF-shin" + s, "DEF-shin" + s + ".001",
                                 "DEF-foot" + s, "DEF-toe" + s});
    const RoleMap roles = detect_roles(rig.joint);
    EXPECT_TRUE(roles.missing().empty());
    EXPECT_EQ(roles[Role::pelvis], rig.index["DEF-spine"]);
    EXPECT_EQ(roles[Role::spine], rig.index["DEF-spine.001"]);
    EXPECT_EQ(roles[Role::chest], rig.index["DEF-spine.003"]);
    EXPECT_EQ(roles[Role::neck], rig.index["DEF-spine.004"]);
    EXPECT_EQ(roles[Role::head], rig.index["DEF-spine.006"]);
    EXPECT_EQ(roles[Role::left_upper_arm], rig.index["DEF-upper_arm.L"]);
    EXPECT_EQ(roles[Role::right_clavicle], rig.index["DEF-shoulder.R"]);
}

TEST(DetectRoles, SideWrittenTogetherWithTheWord) {
    Rig rig;
    rig.chain("", {"hip", "abdomen", "chest", "neck", "head"});
    for (const std::string s : {"l", "r"})
        rig.chain("chest", {s + "Collar", s + "Shldr", s + "ForeArm", s + "Hand"})
            .chain("hip", {s + "thigh", s + "shin", s + "foot"});
    const RoleMap roles = detect_roles(rig.joint);
    EXPECT_TRUE(roles.missing().empty());
    EXPECT_EQ(roles[Role::right_upper_arm], rig.index["rShldr"]);
    EXPECT_EQ(roles[Role::left_lower_leg], rig.index["lshin"]);
}

TEST(DetectRoles, KeepsGivenRolesAndFindsAroundThem) {
    Rig rig;
    rig.chain("", {"a", "b", "c"})
        .chain("c", {"arm_left", "elbow_left", "hand_left"})
        .chain("a", {"left_thigh", "left_knee", "left_foot"});
    RoleMap fixed;
    fixed[Role::pelvis] = 0;
    fixed[Role::left_upper_leg] = rig.index["left_knee"];
    const RoleMap roles = detect_roles(rig.joint, fixed);
    EXPECT_EQ(roles[Role::pelvis], 0);
    EXPECT_EQ(roles[Role::left_upper_leg], rig.index["left_knee"]);
    EXPECT_EQ(roles[Role::left_foot], rig.index["left_foot"]);
    EXPECT_EQ(roles[Role::left_upper_arm], rig.index["arm_left"]);
    EXPECT_EQ(roles[Role::right_hand], -1);
    EXPECT_EQ(roles[Role::head], -1);
}

TEST(DetectRoles, FindsNothingInAProp) {
    Rig rig;
    rig.chain("", {"Base", "Lid", "Hinge_L", "Handle_R"});
    EXPECT_EQ(detect_roles(rig.joint).missing().size(), static_cast<size_t>(role_count));
    EXPECT_EQ(detect_roles({}).missing().size(), static_cast<size_t>(role_count));
}

}  // namespace
}  // namespace toile::skin
