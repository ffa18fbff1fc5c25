#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "cloth/error.h"
#include "generate/scene_config.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;

const char* const body_scene = "[body]\n[contact]\n[poses]\n[garment]\nsource = \"tshirt\"\n";

class SceneConfigTest : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / ("toile_scene_" + std::to_string(getpid()) + "_" + info->name());
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    SceneConfig read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
        const std::string path = (folder_ / "scene.toml").string();
        std::ofstream(path) << text;
        return read_scene(path, overrides);
    }
    std::string error(const std::string& text) const {
        try {
            read(text);
        } catch (const Error& e) {
            return std::string(e.what()) + " (" + e.where() + ") " + e.mend();
        }
        return "no error";
    }
    fs::path folder_;
};

TEST_F(SceneConfigTest, DefaultsAreThoseOfTheRooms) {
    const SceneConfig config = read(body_scene);
    EXPECT_EQ(config.solver.time_step, simulate::SolverOptions().time_step);
    EXPECT_EQ(config.membrane.warp_stiffness, simulate::MembraneOptions().warp_stiffness);
    EXPECT_EQ(config.body->builtin_options.height, skin::BuiltinBodyOptions().height);
    EXPECT_EQ(config.garment.tshirt.edge_length, pattern::TshirtOptions().edge_length);
    EXPECT_EQ(config.poses->sampler.roles, skin::SamplerOptions().roles);
    EXPECT_EQ(config.gate.max_stretch, simulate::GateOptions().max_stretch);
}

TEST_F(SceneConfigTest, AGateProfileSetsBoundsThatKeysOverride) {
    const std::string patch = "[garment]\nsource = \"patch\"\n[gate]\n";
    EXPECT_EQ(read(patch).gate.self_intersections, 0);
    const simulate::GateOptions theirs = read(patch + "profile = \"garmentcode\"\nmax_stretch = 1.5\n").gate;
    EXPECT_EQ(theirs.self_intersections, 300);
    EXPECT_EQ(theirs.max_stretch, 1.5);
    EXPECT_FALSE(theirs.residual_force);
    const SceneConfig paper = read(patch + "body_crossings = 7\nprofile = \"paper\"\n[ladder]\ntries = 1\n");
    EXPECT_FALSE(paper.gate.self_intersections);
    EXPECT_EQ(paper.gate.body_crossings, 7);
    EXPECT_EQ(paper.ladder.tries, 1);
    const SceneConfig again = read_scene_text(paper.absolute_text, "kept.toml", {});
    EXPECT_EQ(again.gate.profile, simulate::GateProfile::paper);
    EXPECT_EQ(again.hash, paper.hash) << "a resolved configuration resolves to itself";
    EXPECT_THAT(error(patch + "profile = \"lax\"\n"), HasSubstr("gate.profile"));
    EXPECT_THAT(error(patch + "[ladder]\ntries = 4\n"), HasSubstr("ladder.tries"));
}

TEST_F(SceneConfigTest, AnAbsentTableIsAnAbsentFeature) {
    const SceneConfig plain = read("[garment]\nsource = \"patch\"\n");
    EXPECT_FALSE(plain.body || plain.poses || plain.bending || plain.contact || plain.image || plain.pins ||
                 plain.table || plain.sphere);
    EXPECT_EQ(left_out(plain).size(), 9u);
    EXPECT_THAT(left_out(plain), Contains(HasSubstr("no [body]: no skinning, no level set")));
    const SceneConfig full = read(std::string(body_scene) +
                                  "[bending]\n[strain_limit]\n[wind]\n[image]\n[pins]\n[table]\n[sphere]\n"
                                  "[evaluate.noise]\n[evaluate.runtime]\n[evaluate.stability]\n[evaluate.strain]\n");
    EXPECT_TRUE(full.body && full.poses && full.bending && full.contact && full.image && full.pins && full.table &&
                full.sphere);
    EXPECT_TRUE(left_out(full).empty());
}

TEST_F(SceneConfigTest, OneSeedServesSamplerAndSplit) {
    const SceneConfig config = read(std::string("[scene]\nseed = 42\n") + body_scene);
    EXPECT_EQ(config.poses->sampler.seed, 42u);
    EXPECT_EQ(config.split.seed, 42u);
}

TEST_F(SceneConfigTest, ReadsLimitsAndRoles) {
    const SceneConfig config = read(std::string(body_scene) +
                                    "[poses.limits]\nleft_upper_arm = { raise = [-1.0, 0.5], twist = [0.0, 0.0] }\n");
    const skin::JointLimit& limit = config.poses->sampler.limits.at(skin::Role::left_upper_arm);
    const skin::JointLimit usual = skin::default_limit(skin::Role::left_upper_arm);
    EXPECT_EQ(limit.lower, Eigen::Vector3d(-1.0, usual.lower[1], 0.0));
    EXPECT_EQ(limit.upper, Eigen::Vector3d(0.5, usual.upper[1], 0.0));
    EXPECT_THAT(error(std::string(body_scene) + "[poses.limits]\nleft_wing = { raise = [0, 1] }\n"),
                HasSubstr("scene.toml:7"));
    EXPECT_THAT(error(std::string(body_scene) + "[poses.limits]\nhead = { raise = [1, 0] }\n"),
                HasSubstr("poses.limits.head.raise is [ 1, 0 ]"));
    EXPECT_THAT(error(std::string(body_scene) + "[poses.limits]\nhead = { lift = [0, 1] }\n"),
                HasSubstr("unknown key poses.limits.head.lift"));
}

TEST_F(SceneConfigTest, APresetIsWhereTheOtherKeysStart) {
    const std::string patch = "[garment]\nsource = \"patch\"\n[material]\npreset = \"denim\"\n";
    const SceneConfig config = read(patch + "shear_stiffness = 77\n[bending]\n");
    EXPECT_EQ(config.membrane.density_per_area, 0.324);
    EXPECT_EQ(config.membrane.shear_stiffness, 77.0);
    EXPECT_NEAR(config.bending->stiffness, 1.85e-5, 0.01e-5);
    EXPECT_EQ(read(patch + "[bending]\nstiffness = 1e-4\n").bending->stiffness, 1e-4);
    EXPECT_FALSE(read(patch).bending);
    EXPECT_EQ(read(config.absolute_text).absolute_text, config.absolute_text);
    EXPECT_THAT(error("[garment]\nsource = \"patch\"\n[material]\npreset = \"chain mail\"\n"),
                HasSubstr("material.preset is \"chain mail\""));
}

TEST_F(SceneConfigTest, ReadsWindLimitAndCompression) {
    const SceneConfig config = read(
        "[garment]\nsource = \"patch\"\n[material]\ncompression = \"tension_field\"\n[wind]\nvelocity = [1, 0, 2]\n"
        "[strain_limit]\nwarp = 1.05\n[bending]\nrest = \"start\"\n");
    EXPECT_EQ(config.membrane.compression, Compression::tension_field);
    EXPECT_EQ(config.wind->velocity, Eigen::Vector3d(1, 0, 2));
    EXPECT_EQ(config.strain_limit->warp, 1.05);
    EXPECT_EQ(config.strain_limit->weft, simulate::StrainLimitOptions().weft);
    EXPECT_EQ(config.bending->rest, simulate::BendingRest::start);
    EXPECT_THAT(error("[garment]\nsource = \"patch\"\n[strain_limit]\nwarp = 1.0\n"), HasSubstr("1.001"));
}

TEST_F(SceneConfigTest, RefusesTablesThatDoNotGoTogether) {
    EXPECT_THAT(error("[scene]\n"), HasSubstr("garment is missing"));
    const std::string patch = "[garment]\nsource = \"patch\"\n";
    for (const char* table : {"poses", "image", "level_set", "path", "split", "output", "predict", "evaluate"})
        EXPECT_THAT(error(patch + "[" + table + "]\n"), HasSubstr("needs [body]")) << table;
    for (const char* table : {"body", "table", "sphere"})
        EXPECT_THAT(error(patch + "[" + table + "]\n"), HasSubstr("needs [contact]")) << table;
    EXPECT_THAT(error(patch + "[contact]\n"), HasSubstr("nothing to touch"));
    EXPECT_THAT(error("[garment]\n"), HasSubstr("no [body]"));
    EXPECT_THAT(error(std::string(body_scene) + "[split]\nvalidation = 0.6\ntest = 0.6\n"), HasSubstr("more than 1"));
    EXPECT_THAT(error(std::string(body_scene) + "[body.roles]\nhead = \"x\"\n"), HasSubstr("unknown table"));
    EXPECT_THAT(error("[body]\nsource = \"file\"\n[contact]\n[garment]\n"), HasSubstr("body.file is missing"));
}

TEST_F(SceneConfigTest, TheResolvedTextIsTheSameScene) {
    const SceneConfig first = read(std::string(body_scene) + "[image]\nsize = 128\n[pins]\nvertex = [3, 4]\n",
                                   {"simulate.time_step=0.02", "poses.limits.head.raise=[-0.25, 0.25]"});
    const SceneConfig second = read(first.absolute_text);
    EXPECT_EQ(second.absolute_text, first.absolute_text);
    EXPECT_EQ(second.hash, first.hash);
    EXPECT_EQ(second.solver.time_step, 0.02);
    EXPECT_EQ(second.image->size, 128);
    EXPECT_NE(read(body_scene).hash, first.hash);
}

TEST_F(SceneConfigTest, WhatIsEvaluatedDoesNotChangeTheData) {
    const SceneConfig plain = read(body_scene);
    EXPECT_EQ(plain.predict.predictor.front(), "ridge");
    EXPECT_FALSE(plain.evaluate.noise || plain.evaluate.runtime || plain.evaluate.stability || plain.evaluate.strain);
    const SceneConfig other = read(std::string(body_scene) +
                                   "[predict]\npredictor = [\"mean\"]\n[evaluate]\nlimit = [0.01]\nmu = [1]\n"
                                   "learn_mu = \"none\"\nsamples = 5\n[evaluate.runtime]\nstudy = [\"priors\"]\n");
    EXPECT_EQ(other.predict.predictor, (std::vector<std::string>{"mean"}));
    EXPECT_EQ(other.evaluate.limit, (std::vector<double>{0.01}));
    EXPECT_EQ(other.evaluate.mu, (std::vector<double>{1.0}));
    EXPECT_EQ(other.evaluate.learn_mu, "none");
    EXPECT_EQ(other.evaluate.samples, 5);
    EXPECT_EQ(other.evaluate.runtime->study, (std::vector<std::string>{"priors"}));
    EXPECT_EQ(other.hash, plain.hash);
    EXPECT_EQ(other.text, plain.text);
    EXPECT_EQ(read(other.absolute_text).absolute_text, other.absolute_text);
    EXPECT_THAT(error(std::string(body_scene) + "[predict]\npredictor = [\"oracle\"]\n"), HasSubstr("ridge, nearest"));
    EXPECT_THAT(error(std::string(body_scene) + "[predict]\npredictor = []\n"), HasSubstr("empty list"));
    EXPECT_THAT(error(std::string(body_scene) + "[evaluate]\nmu = [0]\n"), HasSubstr("evaluate.mu"));
    EXPECT_THAT(error(std::string(body_scene) + "[evaluate.noise]\nshare = 0\n"), HasSubstr("evaluate.noise.share"));
}

TEST_F(SceneConfigTest, TheScenesOfTheRepositoryRead) {
    for (const char* name : {"quick", "tshirt", "patch"})
        EXPECT_NO_THROW(read_scene(std::string(TOILE_SOURCE_DIR) + "/configs/" + name + ".toml", {})) << name;
    if (!fs::exists(TOILE_SHARED_DATA)) GTEST_SKIP() << "the shared data is not beside this clone";
    EXPECT_NO_THROW(read_scene(std::string(TOILE_SOURCE_DIR) + "/configs/real_body.toml", {}));
}

/// Every key of a resolved configuration stands in the README's table of keys.
TEST_F(SceneConfigTest, TheReadmeNamesEveryKey) {
    std::ifstream stream(std::string(TOILE_SOURCE_DIR) + "/README.md");
    const std::string readme{std::istreambuf_iterator<char>(stream), {}};
    // scene.toml stands for any file that is there
    const std::vector<std::string> scene = {
        std::string(body_scene) + "[bending]\n[strain_limit]\n[wind]\n[image]\n[pins]\n[table]\n[sphere]\n",
        "[body]\nsource = \"file\"\nfile = \"scene.toml\"\n[contact]\n[poses]\nsource = \"bvh\"\nfile = "
        "\"scene.toml\"\n"
        "[garment]\nsource = \"file\"\nfile = \"scene.toml\"\n",
        "[garment]\nsource = \"patch\"\n"};
    int keys = 0;
    for (const std::string& text : scene) {
        std::istringstream lines(read(text).text);
        const std::regex key_line("^(# )?([a-z_]+)( = |: not given).*");
        for (std::string line; std::getline(lines, line);) {
            std::smatch match;
            if (!std::regex_match(line, match, key_line)) continue;
            EXPECT_THAT(readme, HasSubstr("`" + match[2].str() + "`"));
            ++keys;
        }
    }
    EXPECT_GT(keys, 60);
}

}  // namespace
}  // namespace toile::generate
