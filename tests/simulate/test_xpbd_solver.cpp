#include <gtest/gtest.h>

#include <cmath>

#include "simulate/xpbd_solver.h"
#include "tests/support/drape_scenes.h"

namespace toile::simulate {
namespace {

constexpr double edge_length = 0.05;

DrapeScene hung_patch() {
    return test::hanging_square(6, 0.3);
}

/// Over the top of a sphere without friction, held by two vertices in its middle: without them it would slide off, and
/// with one it could turn.
DrapeScene patch_on_sphere() {
    DrapeScene scene;
    scene.mesh = test::cloth_square(6, 0.3, 0.503);
    scene.mesh.rest_position = test::crumpled(scene.mesh.rest_position, 0.0001);
    scene.bending = BendingOptions{};
    scene.contact = ContactOptions{};
    scene.contact->friction = 0.0;
    scene.sphere = SphereOptions{{0, 0, 0}, 0.5};
    scene.pinned = {24, 25};
    return scene;
}

Positions drape_of(DrapeScene scene, const std::string& solver, double residual, int iterations) {
    scene.ladder.tries = 0;
    scene.solver.solver = solver;
    scene.solver.residual_tolerance = residual;
    scene.solver.speed_tolerance = 1e-5;
    scene.solver.max_iterations = iterations;
    return Draper(scene).drape_neutral().position;
}

double largest_distance(const Positions& a, const Positions& b) {
    return std::sqrt((a - b).rowwise().squaredNorm().maxCoeff());
}

/// As published, without forces that are kept: refinements come nearer to the implicit drape, and with small steps the
/// distance falls with their square, to four at a halving. (Steps must be so small that no constraint is stiffer than
/// they are: a sweep then misses little of what constraints do to each other.)
void expect_refinements_come_nearer(DrapeScene scene) {
    const Positions implicit = drape_of(scene, "implicit", 1e-6, 2000);
    scene.solver.xpbd.keep_forces = false;
    const auto distance = [&](int substeps, int iterations) {
        scene.solver.xpbd.substeps = substeps;
        scene.solver.xpbd.iterations = iterations;
        return largest_distance(drape_of(scene, "xpbd", 1e-6, 120), implicit);
    };
    const double coarse = distance(20, 1), fine = distance(80, 1), finer = distance(160, 1), finest = distance(320, 1);
    EXPECT_LT(fine, 0.5 * coarse);
    EXPECT_LT(finer, 0.5 * fine);
    EXPECT_NEAR(finer / finest, 4.0, 0.5);
    const double more = distance(20, 4), most = distance(20, 32);
    EXPECT_LT(more, 0.5 * coarse);
    EXPECT_LT(most, 0.02 * more) << "sweeps converge linearly";
}

TEST(XpbdSolver, ComesNearerToImplicitWithEveryRefinementWhereAPatchHangs) {
    expect_refinements_come_nearer(hung_patch());
}

TEST(XpbdSolver, ComesNearerToImplicitWithEveryRefinementOnASphere) {
    expect_refinements_come_nearer(patch_on_sphere());
}

TEST(XpbdSolver, KeptForcesReachTheSameRest) {
    for (const DrapeScene& scene : {hung_patch(), patch_on_sphere()}) {
        const Positions implicit = drape_of(scene, "implicit", 1e-6, 2000);
        for (const int substeps : {20, 40}) {
            DrapeScene coarse = scene;
            coarse.solver.xpbd.substeps = substeps;
            EXPECT_LT(largest_distance(drape_of(coarse, "xpbd", 1e-5, 2000), implicit), 0.001 * edge_length)
                << substeps;
        }
    }
}

/// What a scene may ask for besides.
std::vector<std::pair<std::string, DrapeScene>> hung_patches_with_more() {
    std::vector<std::pair<std::string, DrapeScene>> scenes;
    DrapeScene& blown = scenes.emplace_back("wind", hung_patch()).second;
    blown.wind = WindOptions{};
    blown.wind->velocity = {0.15, 0.0, 0.75};  // twice as strong it could rest in two shapes
    DrapeScene& limited = scenes.emplace_back("strain limit", hung_patch()).second;
    limited.membrane.warp_stiffness = limited.membrane.weft_stiffness = 20.0;
    limited.membrane.shear_stiffness = 6.0;
    limited.strain_limit = StrainLimitOptions{1.01, 1.01};
    DrapeScene& folded = scenes.emplace_back("folds", hung_patch()).second;
    for (int v = 0; v < folded.mesh.vertex_count(); ++v)
        folded.mesh.rest_position(v, 1) += 0.02 * std::cos(20.0 * folded.mesh.rest_position(v, 0));
    folded.bending = BendingOptions{1e-3, BendingRest::start};
    return scenes;
}

TEST(XpbdSolver, RestsWhereImplicitDoesInWindAtALimitAndAboutAFoldedStart) {
    for (const auto& [what, scene] : hung_patches_with_more()) {
        const Positions implicit = drape_of(scene, "implicit", 1e-6, 2000);
        DrapeScene without = scene;
        without.wind.reset();
        without.strain_limit.reset();
        without.bending->rest = BendingRest::flat;
        EXPECT_GT(largest_distance(drape_of(without, "implicit", 1e-6, 2000), implicit), 0.02 * edge_length)
            << what << " must make a difference";
        EXPECT_LT(largest_distance(drape_of(scene, "xpbd", 1e-5, 2000), implicit), 0.002 * edge_length) << what;
    }
}

TEST(XpbdSolver, RestsWithinTheGateOfImplicit) {
    DrapeScene scene = hung_patch();
    scene.solver.solver = "xpbd";
    const DrapeResult result = Draper(scene).drape_neutral();
    EXPECT_EQ(result.status, DrapeStatus::accepted) << status_reason(result.status);
    EXPECT_LE(result.certificate.residual_force, scene.solver.residual_tolerance);
    EXPECT_EQ(result.position.row(42), scene.mesh.rest_position.row(42));
}

TEST(XpbdSolver, FollowsABendingBodyTheSameWayTwice) {
    DrapeScene scene = test::square_on_pillar(8);
    scene.ladder.tries = 0;
    scene.solver.solver = "xpbd";
    scene.solver.max_iterations = 100;
    const Draper draper(scene);
    const DrapeResult neutral = draper.drape_neutral();
    const DrapeResult posed = draper.drape(neutral.position, skin::bent_pillar(0.3));
    EXPECT_LE(posed.certificate.body_penetration, 0.0005);
    const double moved = posed.position.col(0).mean() - neutral.position.col(0).mean();
    EXPECT_NEAR(moved, -0.5 * std::sin(0.3), 0.05) << "the pillar's top moves aside and the square with it";
    EXPECT_EQ(draper.drape(neutral.position, skin::bent_pillar(0.3)).position, posed.position);
}

}  // namespace
}  // namespace toile::simulate
