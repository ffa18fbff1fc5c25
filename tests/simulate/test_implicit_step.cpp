#include <gtest/gtest.h>

#include "simulate/implicit_step.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

struct Fixture {
    explicit Fixture(int cells = 6) : mesh(test::cloth_square(cells, 0.3, 0.0)) { elasticity.bind(*symbolic); }
    ClothMesh mesh;
    Topology topology = build_topology(mesh.triangle);
    Elasticity elasticity{mesh, topology, {}, BendingOptions{}, {0, -9.81, 0}};
    std::shared_ptr<const BlockSymbolic> symbolic =
        std::make_shared<const BlockSymbolic>(mesh.vertex_count(), elasticity.pairs());
    std::vector<int> pinned;
    DrapeReport report;
};

TEST(ImplicitStep, FreeFallIsExact) {
    // Nothing but gravity: one implicit Euler step from rest moves every vertex by h² g.
    Fixture f;
    ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 0.0);
    Positions x = f.mesh.rest_position;
    const ImplicitStep::Target target{&f.mesh.rest_position, &f.mesh.rest_position, 0.01};
    const ImplicitStep::Iteration done = step.iterate(target, x, f.report);
    EXPECT_EQ(done.step_share, 1.0);
    const Positions move = x - f.mesh.rest_position;
    EXPECT_LT((move.col(1).array() + 9.81e-4).abs().maxCoeff(), 1e-12);
    EXPECT_LT(move.col(0).norm() + move.col(2).norm(), 1e-12);
}

TEST(ImplicitStep, DampingSlowsTheFall) {
    Fixture f;
    ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 50.0);
    Positions x = f.mesh.rest_position;
    step.iterate({&f.mesh.rest_position, &f.mesh.rest_position, 0.01}, x, f.report);
    // (1/h² + α/h) Δ = g
    EXPECT_NEAR((x - f.mesh.rest_position)(0, 1), -9.81 / (1e4 + 50.0 / 0.01), 1e-12);
}

TEST(ImplicitStep, PinnedVerticesStay) {
    Fixture f;
    f.pinned = {0, 6};
    ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 0.0);
    Positions x = f.mesh.rest_position;
    for (int k = 0; k < 5; ++k) step.iterate({&f.mesh.rest_position, &f.mesh.rest_position, 0.05}, x, f.report);
    for (int v : f.pinned) EXPECT_EQ(x.row(v), f.mesh.rest_position.row(v));
    EXPECT_LT(x(3, 1), -1e-4) << "between the pins it sags";
}

TEST(ImplicitStep, TrueCurvatureFindsTheBuckledRestInFewerIterations) {
    // A square held at two corners that are nearer to each other than its width: it must fold.
    const auto iterations_to_rest = [](bool true_curvature, double& energy) {
        Fixture f(20);
        f.pinned = {0, 20};
        ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 0.0);
        Positions x = test::crumpled(f.mesh.rest_position, 0.001);
        x.row(0) += 0.1 * (x.row(20) - x.row(0));
        int k = 0;
        for (; k < 2000 && (k == 0 || step.static_residual(x, f.report) > 1e-7); ++k) {
            const Positions before = x;
            step.iterate({&before, &before, 1e3, true_curvature}, x, f.report);
        }
        energy = f.elasticity.energy(x);
        return k;
    };
    double projected_energy = 0.0, true_energy = 0.0;
    const int projected = iterations_to_rest(false, projected_energy);
    const int with_true = iterations_to_rest(true, true_energy);
    EXPECT_LT(with_true, projected);
    EXPECT_LT(with_true, 300);
    EXPECT_NEAR(true_energy, projected_energy, 1e-3 * std::abs(projected_energy));
}

TEST(ImplicitStep, MomentumIsKeptWithoutForces) {
    Fixture f;
    Elasticity weightless(f.mesh, f.topology, {}, BendingOptions{}, {0, 0, 0});
    weightless.bind(*f.symbolic);
    ImplicitStep step(f.mesh, weightless, f.symbolic, f.pinned, {}, nullptr, 0.0);
    const Positions start = test::crumpled(f.mesh.rest_position, 0.003);
    const Eigen::RowVector3d velocity(0.3, -0.2, 0.5);
    Positions inertial = start, x = start;
    inertial.rowwise() += 0.01 * velocity;
    for (int k = 0; k < 30; ++k) step.iterate({&start, &inertial, 0.01}, x, f.report);
    const Eigen::RowVector3d momentum = f.mesh.mass.transpose() * (x - start) / 0.01;
    EXPECT_LT((momentum - f.mesh.mass.sum() * velocity).norm(), 1e-7 * momentum.norm());
}

TEST(ImplicitStep, EveryIterationLowersTheEnergy) {
    // With a time step that long inertia is nothing, and the pins keep the cloth from falling away.
    Fixture f;
    f.pinned = {0, 6};
    ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 0.0);
    const Positions start = test::crumpled(f.mesh.rest_position, 0.02);
    Positions x = start;
    double before = f.elasticity.energy(x);
    for (int k = 0; k < 10; ++k) {
        step.iterate({&start, &start, 1e3}, x, f.report);
        const double after = f.elasticity.energy(x);
        EXPECT_LE(after, before + 1e-9 * std::abs(before));
        before = after;
    }
}

TEST(ImplicitStep, SaysSoWhereItCannotMove) {
    Fixture f;
    ImplicitStep step(f.mesh, f.elasticity, f.symbolic, f.pinned, {}, nullptr, 0.0);
    Positions x = f.mesh.rest_position;
    x(3, 1) = std::numeric_limits<double>::quiet_NaN();
    const ImplicitStep::Iteration done =
        step.iterate({&f.mesh.rest_position, &f.mesh.rest_position, 0.01}, x, f.report);
    EXPECT_EQ(done.step_share, 0.0);
}

}  // namespace
}  // namespace toile::simulate
