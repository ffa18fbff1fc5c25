#include <gtest/gtest.h>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "simulate/drape.h"
#include "tests/simulate/cloth_square.h"
#include "tests/simulate/pillar_body.h"

namespace toile::simulate {
namespace {

DrapeScene hanging_square() {
    DrapeScene scene;
    scene.mesh = test::cloth_square(10, 0.5, 1.0);
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 0.0005);
    scene.bending = BendingOptions{};
    scene.pinned = {110, 120};
    return scene;
}

/// A square on top of a pillar whose upper half bends.
DrapeScene square_on_pillar() {
    DrapeScene scene;
    scene.mesh = test::cloth_square(12, 0.3, 1.01);
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 0.0005);
    scene.bending = BendingOptions{};
    scene.contact = ContactOptions{};
    scene.body = test::pillar_body();
    scene.level_set.voxel = 0.008;
    return scene;
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

TEST(Drape, ABentBodyCarriesItsCloth) {
    const DrapeScene scene = square_on_pillar();
    const Draper draper(scene);
    const DrapeResult neutral = draper.drape_neutral();
    ASSERT_EQ(neutral.status, DrapeStatus::accepted) << status_reason(neutral.status);
    const DrapeResult posed = draper.drape(neutral.position, test::bent(0.3));
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
        return [&](int, int k) { slots[k] = draper.drape(neutral, test::bent(k == 0 ? 0.2 : -0.15)).position; };
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
