#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth/error.h"
#include "generate/project_config.h"

namespace toile::generate {
namespace {

using ::testing::HasSubstr;

TEST(ProjectConfig, DefaultsAreThoseOfThePriors) {
    const ProjectConfig limits = read_project_config(Prior::inextensibility, {});
    EXPECT_EQ(limits.stretch_limit, 0.0);
    EXPECT_EQ(limits.tolerance(), prior::InextensibilityOptions{}.tolerance);
    const ProjectConfig springs = read_project_config(Prior::quasistatic, {});
    EXPECT_EQ(springs.mu, 0.1);
    EXPECT_EQ(springs.stiffness.stretch, prior::QuasistaticStiffness{}.stretch);
    EXPECT_EQ(springs.tolerance(), prior::QuasistaticOptions{}.tolerance);
}

TEST(ProjectConfig, KeysAreReadAndPrinted) {
    const ProjectConfig config = read_project_config(
        Prior::quasistatic, {"method=newton_cg", "mu=0.5", "stretch_stiffness=1e3", "bending_stiffness=0",
                             "axial_stiffness=2", "tolerance=1e-8", "max_iterations=7"});
    EXPECT_EQ(config.quasistatic.method, prior::QuasistaticOptions::Method::newton_cg);
    EXPECT_EQ(config.mu, 0.5);
    EXPECT_EQ(config.stiffness.stretch, 1e3);
    EXPECT_EQ(config.stiffness.bending, 0.0);
    EXPECT_EQ(config.stiffness.axial, 2.0);
    EXPECT_EQ(config.tolerance(), 1e-8);
    EXPECT_EQ(config.quasistatic.max_iterations, 7);
    for (const char* line : {"method = \"newton_cg\"", "mu = 0.5", "axial_stiffness = 2.0"})
        EXPECT_THAT(config.text, HasSubstr(line));
    EXPECT_NE(config.hash, read_project_config(Prior::quasistatic, {}).hash);
}

TEST(ProjectConfig, WhatIsWrongComesWithTheListOfKeys) {
    for (const char* bad : {"limit=1", "stretch_limit=-1", "stretch_limit=nan", "tolerance=1", "method=\"x\"", "=1"}) {
        try {
            read_project_config(Prior::inextensibility, {bad});
            ADD_FAILURE() << bad << " was read";
        } catch (const Error& error) {
            EXPECT_EQ(error.where().rfind("--set", 0), 0u) << bad;
            EXPECT_EQ(error.mend(), "keys: method, stretch_limit, tolerance, max_iterations") << bad;
        }
    }
}

}  // namespace
}  // namespace toile::generate
