#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulate/drape.h"
#include "simulate/ladder.h"
#include "tests/support/drape_scenes.h"

namespace toile::simulate {
namespace {

using testing::ElementsAre;

DrapeScene hanging_square() {
    return test::hanging_square(8, 0.4);
}

DrapeScene square_on_pillar() {
    return test::square_on_pillar(8);
}

std::vector<int> rungs_of(const DrapeResult& result) {
    std::vector<int> rung;
    for (const TryRecord& one : result.tries) rung.push_back(one.rung);
    return rung;
}

TEST(Ladder, HasItsRungsInOrder) {
    EXPECT_THAT(rungs({3}, true), ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(rungs({1}, true), ElementsAre(0, 1));
    EXPECT_THAT(rungs({0}, true), ElementsAre(0));
    EXPECT_THAT(rungs({3}, false), ElementsAre(0, 1, 3)) << "without a pose there is no path to lengthen";
    for (int rung = 1; rung < rung_count; ++rung) EXPECT_NE(rung_name(rung), rung_name(rung - 1));
}

TEST(Ladder, EachRungTakesMoreEffortThanTheOneBelow) {
    const DrapeScene scene = hanging_square();
    const DrapeScene smaller = rung_scene(scene, 1), other = rung_scene(scene, 3);
    EXPECT_EQ(rung_scene(scene, 0).schedule.joint_step, scene.schedule.joint_step);
    EXPECT_EQ(smaller.schedule.joint_step, 0.5 * scene.schedule.joint_step);
    EXPECT_EQ(smaller.solver.time_step, 0.5 * scene.solver.time_step);
    EXPECT_EQ(smaller.schedule.path_iterations, 2 * scene.schedule.path_iterations);
    EXPECT_EQ(smaller.solver.max_iterations, scene.solver.max_iterations);
    EXPECT_GT(other.solver.damping, scene.solver.damping);
    EXPECT_EQ(other.solver.max_iterations, 2 * scene.solver.max_iterations);
}

TEST(Ladder, TheLongerPathMovesTheTrunkThenTheLimbsFromTheirRoots) {
    skin::Body body;
    for (const char* name : {"hips", "arm", "forearm", "hand"})
        body.joint.push_back({name, static_cast<int>(body.joint.size()) - 1, Eigen::Matrix4d::Identity()});
    body.role[skin::Role::left_upper_arm] = 1;
    body.role[skin::Role::left_lower_arm] = 2;
    const skin::Pose pose = skin::Pose::Constant(4, 3, 0.2);
    EXPECT_EQ(rung_path(body, pose, 1).size(), 1u);
    const std::vector<skin::Pose> path = rung_path(body, pose, 2);
    ASSERT_EQ(path.size(), 3u);
    EXPECT_TRUE(path[0].row(0) == pose.row(0) && path[0].bottomRows(3).isZero(0.0));
    EXPECT_TRUE(path[1].topRows(2) == pose.topRows(2) && path[1].bottomRows(2).isZero(0.0));
    EXPECT_EQ(path[2], pose);
    EXPECT_EQ(rung_path(body, skin::Pose::Zero(4, 3), 2).size(), 1u);
}

TEST(Ladder, KeepsWhatGotFurthest) {
    const auto made = [](DrapeStatus status, double residual) {
        DrapeResult result;
        result.status = status;
        result.certificate.residual_force = residual;
        return result;
    };
    const DrapeResult wild = made(DrapeStatus::not_finite, 0.0), moving = made(DrapeStatus::not_at_rest, 1.0),
                      calmer = made(DrapeStatus::not_at_rest, 0.1), deep = made(DrapeStatus::penetrates_body, 2.0);
    EXPECT_TRUE(better(moving, wild));
    EXPECT_TRUE(better(calmer, moving));
    EXPECT_FALSE(better(moving, calmer));
    EXPECT_TRUE(better(deep, calmer));
}

TEST(Ladder, AShortBudgetIsMadeUpForAndRecorded) {
    DrapeScene scene = hanging_square();
    const DrapeResult at_once = Draper(scene).drape_neutral();
    ASSERT_EQ(at_once.status, DrapeStatus::accepted);
    EXPECT_THAT(rungs_of(at_once), ElementsAre(0));
    EXPECT_EQ(at_once.certificate.tries, 1);

    scene.solver.max_iterations = at_once.certificate.iterations * 2 / 3;
    scene.ladder.tries = 0;
    const DrapeResult refused = Draper(scene).drape_neutral();
    EXPECT_EQ(refused.status, DrapeStatus::not_at_rest);
    EXPECT_THAT(rungs_of(refused), ElementsAre(0));

    scene.ladder.tries = 3;
    const DrapeResult climbed = Draper(scene).drape_neutral();
    EXPECT_EQ(climbed.status, DrapeStatus::accepted) << status_reason(climbed.status);
    EXPECT_EQ(climbed.certificate.tries, static_cast<int>(climbed.tries.size()));
    EXPECT_EQ(climbed.certificate.rung, climbed.tries.back().rung);
    EXPECT_GT(climbed.tries.size(), 1u);
    EXPECT_EQ(climbed.tries.front().status, DrapeStatus::not_at_rest);
    int iterations = 0;
    for (const TryRecord& one : climbed.tries) iterations += one.certificate.iterations;
    EXPECT_EQ(climbed.certificate.iterations, iterations);
    EXPECT_EQ(Draper(scene).drape_neutral().position, climbed.position);
}

TEST(Ladder, AGateThatCannotBeMetEndsInItsReason) {
    DrapeScene scene = square_on_pillar();
    scene.gate.max_stretch = 1.0;
    const DrapeResult result = Draper(scene).drape(scene.mesh.rest_position, skin::bent_pillar(0.2));
    EXPECT_EQ(result.status, DrapeStatus::overstretched) << status_reason(result.status);
    EXPECT_THAT(rungs_of(result), ElementsAre(0, 1, 2, 3));
    EXPECT_LE(result.certificate.residual_force, *scene.gate.residual_force);
}

TEST(Ladder, ABodyFoldedIntoItselfIsToldApart) {
    DrapeScene scene = square_on_pillar();
    scene.mesh.rest_position.rowwise() += Eigen::RowVector3d(0.28, -0.75, 0.0);  // beside the fold, held by a side
    for (int v = 0; v < 9; ++v) scene.pinned.push_back(9 * v);
    scene.gate.max_stretch = 1.0;  // so that it fails for certain
    const DrapeResult result = Draper(scene).drape(scene.mesh.rest_position, skin::bent_pillar(2.9));
    EXPECT_EQ(result.status, DrapeStatus::body_intersects_itself) << status_reason(result.status);
    EXPECT_THAT(rungs_of(result), ElementsAre(0)) << "no other path leads to a pose that is impossible";
    EXPECT_NE(result.tries[0].status, DrapeStatus::body_intersects_itself) << "what the solver said is kept";
}

TEST(Ladder, ASettlingThatStallsEndsEarly) {
    DrapeScene scene = hanging_square();
    scene.solver.speed_tolerance = 1e-300;
    scene.solver.max_iterations = 100000;
    scene.solver.stall_iterations = 100;
    scene.ladder.tries = 0;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_LT(result.certificate.iterations, 2000);
    EXPECT_LT(result.certificate.residual_force, 1e-6) << "only once nothing was left to gain";
}

}  // namespace
}  // namespace toile::simulate
