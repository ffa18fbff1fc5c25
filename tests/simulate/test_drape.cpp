#include <gtest/gtest.h>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "simulate/drape.h"
#include "tests/support/drape_scenes.h"

namespace toile::simulate {
namespace {

DrapeScene hanging_square() {
    return test::hanging_square(10, 0.5);
}

DrapeScene square_on_pillar() {
    return test::square_on_pillar(12);
}

TEST(Drape, AHangingSquareRestsBelowItsPins) {
    const DrapeScene scene = hanging_square();
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::accepted) << status_reason(result.status);
    EXPECT_LE(result.certificate.residual_force, scene.solver.residual_tolerance);
    EXPECT_LT(result.certificate.max_stretch, 1.1);
    EXPECT_LT(result.position.row(0)[1], 0.6) << "the free corner hangs half a metre down";
    EXPECT_EQ(result.position.row(110), scene.mesh.rest_position.row(110));
    // The pins carry the weight, so the centre of mass lies below their middle.
    const Eigen::RowVector3d centre = scene.mesh.mass.transpose() * result.position / scene.mesh.mass.sum();
    const Eigen::RowVector3d middle = 0.5 * (result.position.row(110) + result.position.row(120));
    EXPECT_NEAR(centre.x(), middle.x(), 0.002);
    EXPECT_NEAR(centre.z(), middle.z(), 0.002);
}

TEST(Drape, ASquareOnATableLiesFlatAtItsThickness) {
    DrapeScene scene;
    scene.mesh = test::cloth_square(8, 0.4, 0.05);
    scene.bending = BendingOptions{};
    scene.contact = ContactOptions{};
    scene.table = TableOptions{0.0};
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::accepted);
    EXPECT_GT(result.position.col(1).minCoeff(), 0.5 * scene.contact->thickness);
    EXPECT_LT(result.position.col(1).maxCoeff(), scene.contact->thickness);
}

TEST(Drape, ASphereHoldsASquareByFriction) {
    DrapeScene scene;
    scene.mesh = test::cloth_square(12, 0.6, 0.53);
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 0.001);
    scene.bending = BendingOptions{};
    scene.contact = ContactOptions{};
    scene.sphere = SphereOptions{{0, 0.3, 0}, 0.2};
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::accepted);
    double nearest = 1.0;
    for (int v = 0; v < result.position.rows(); ++v)
        nearest = std::min(nearest, (result.position.row(v) - Eigen::RowVector3d(0, 0.3, 0)).norm());
    EXPECT_GT(nearest, 0.2);
    EXPECT_LT(nearest, 0.2 + scene.contact->thickness);
}

/// A square over a sphere of 0.2 m, its corners pinned at a height.
DrapeScene square_pulled_over_a_sphere(double density, double stiffness, double corner_height) {
    DrapeScene scene;
    scene.mesh = test::cloth_square(10, 0.4, 0.21, density);
    scene.membrane = {density, stiffness, stiffness, 0.3 * stiffness};
    scene.bending.emplace();
    scene.contact.emplace();
    scene.sphere = SphereOptions{{0, 0, 0}, 0.2};
    scene.pinned = {0, 10, 110, 120};
    for (const int v : scene.pinned) scene.mesh.rest_position(v, 1) = corner_height;
    scene.gate.max_stretch.reset();
    scene.ladder.tries = 0;
    return scene;
}

TEST(Drape, NeitherWeightNorTensionPressesClothIntoASolid) {
    for (const DrapeScene& scene :
         {square_pulled_over_a_sphere(10.0, 5.0, 0.0),      // heavy, and as soft as can be
          square_pulled_over_a_sphere(0.2, 1000.0, -1.0)})  // stretched beyond the first guess
    {
        const DrapeResult result = Draper(scene).drape_neutral();
        EXPECT_EQ(result.status, DrapeStatus::accepted) << status_reason(result.status);
        EXPECT_GT(result.position.rowwise().norm().minCoeff(), 0.2 - 1e-4);
    }
}

TEST(Drape, AStiffPatchIsNotGivenUpWhileItFalls) {
    // While a nearly inextensible patch swings down, its residual swings about at many times its weight.
    DrapeScene scene = test::hanging_square(10, 0.5);
    scene.mesh.rest_position.row(110) << -0.25, 1.0, -0.25;
    scene.mesh.rest_position.row(120) << 0.25, 1.0, -0.25;
    scene.membrane.warp_stiffness = scene.membrane.weft_stiffness = 1e7;
    scene.membrane.shear_stiffness = 3e6;
    scene.solver.stall_iterations = 100;
    scene.ladder.tries = 0;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::accepted) << status_reason(result.status);
    EXPECT_LT(result.position.col(1).mean(), 0.9);
}

TEST(Drape, WhatNothingHoldsIsGivenUpSoon) {
    DrapeScene scene = hanging_square();
    scene.pinned.clear();
    scene.ladder.tries = 0;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::not_at_rest);
    EXPECT_LT(result.certificate.iterations, 2 * scene.solver.stall_iterations);
}

TEST(Drape, ABentBodyCarriesItsCloth) {
    const DrapeScene scene = square_on_pillar();
    const Draper draper(scene);
    const DrapeResult neutral = draper.drape_neutral();
    ASSERT_EQ(neutral.status, DrapeStatus::accepted) << status_reason(neutral.status);
    const DrapeResult posed = draper.drape(neutral.position, skin::bent_pillar(0.3));
    EXPECT_EQ(posed.status, DrapeStatus::accepted) << status_reason(posed.status);
    EXPECT_LE(posed.certificate.body_penetration, 0.0005);
    const double moved = posed.position.col(0).mean() - neutral.position.col(0).mean();
    EXPECT_NEAR(moved, -0.5 * std::sin(0.3), 0.05) << "the pillar's top moves aside and the square with it";
    EXPECT_GT(posed.report.level_sets, 0);
}

TEST(Drape, TheSameBytesOnOneThreadAndTwo) {
    const DrapeScene scene = square_on_pillar();
    const Draper draper(scene);
    const Positions neutral = draper.drape_neutral().position;
    std::vector<Positions> alone(2), together(2);
    const auto drape_into = [&](std::vector<Positions>& slots) {
        return [&](int, int k) { slots[k] = draper.drape(neutral, skin::bent_pillar(k == 0 ? 0.2 : -0.15)).position; };
    };
    parallel_for(2, 1, drape_into(alone));
    parallel_for(2, 2, drape_into(together));
    for (int k = 0; k < 2; ++k) EXPECT_EQ(alone[k], together[k]);
}

TEST(Drape, WithoutBodyThereIsNoLevelSetAndNoContact) {
    const DrapeResult result = Draper(hanging_square()).drape_neutral();
    EXPECT_EQ(result.report.level_sets, 0);
    EXPECT_EQ(result.certificate.body_penetration, 0.0);
}

TEST(Drape, AnExhaustedBudgetIsAStatusNotAnError) {
    DrapeScene scene = hanging_square();
    scene.solver.max_iterations = 2;
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::not_at_rest);
    EXPECT_TRUE(result.position.allFinite());
}

TEST(Drape, RefusesContactlessSolidsOneByOne) {
    EXPECT_NO_THROW(Draper{hanging_square()});
    DrapeScene scene = hanging_square();
    scene.table = TableOptions{};
    EXPECT_THROW(Draper{scene}, Error);
    scene = hanging_square();
    scene.sphere = SphereOptions{};
    EXPECT_THROW(Draper{scene}, Error);
}

TEST(Drape, RefusesWhatCannotBeDraped) {
    DrapeScene scene = hanging_square();
    scene.mesh.mass[3] = 0.0;
    EXPECT_THROW(Draper{scene}, Error) << "a vertex without mass";
    scene = hanging_square();
    scene.pinned = {100000};
    EXPECT_THROW(Draper{scene}, Error) << "a pin on no vertex";
    scene = hanging_square();
    scene.mesh.rest_position(0, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(Draper{scene}, Error) << "a position that is not finite";
    const Draper draper(hanging_square());
    EXPECT_THROW(draper.drape(hanging_square().mesh.rest_position, skin::Pose::Zero(2, 3)), Error) << "no body to pose";
}

}  // namespace
}  // namespace toile::simulate
