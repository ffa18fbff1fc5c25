#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "simulate/drape.h"
#include "simulate/self_intersection.h"
#include "simulate/xpbd_step.h"
#include "tests/simulate/two_layers.h"

namespace toile::simulate {
namespace {

constexpr double pressure = 2e4;

struct Fixture {
    ClothMesh mesh;
    Topology topology;
    SelfContactOptions options{.thickness = 0.002, .friction = 0.3};
    XpbdSelfContact contact;
    XpbdSystem system;
    XpbdParameters parameters;

    explicit Fixture(double gap)
        : mesh(test::two_layers(gap)),
          topology(build_topology(mesh.triangle)),
          contact(mesh, topology, options, pressure),
          system{XpbdConstraints(mesh, topology, {}, BendingOptions{}), {}, Positions::Zero(mesh.vertex_count(), 3)} {
        system.self_contact = &contact;
        parameters.time_step = 0.001;
        parameters.inverse_mass = mesh.mass.cwiseInverse();
        parameters.largest_move = 0.001;
    }
    /// The upper layer comes down on the lower one, each vertex a little differently.
    XpbdState thrown(double speed) const {
        XpbdState state = system.state_at(mesh.rest_position);
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            const double side = v < mesh.vertex_count() / 2 ? 1.0 : -1.0;
            state.velocity.row(v) = speed * Eigen::RowVector3d(0.3 * std::sin(5.0 * v), side, 0.3 * std::cos(3.0 * v));
        }
        return state;
    }
};

TEST(XpbdSelfContact, StaticForcesAreThoseOfTheBarrier) {
    for (const double gap : {0.0015, 0.0002}) {
        Fixture f(gap);
        const Positions x = test::crumpled(f.mesh.rest_position, 0.1 * gap);
        SelfContact barrier(f.mesh, f.topology, f.options, pressure);
        barrier.begin_step(x, 0.01);
        barrier.look_around(x);
        barrier.linearise(x);
        Positions gradient = Positions::Zero(x.rows(), 3), force = gradient;
        barrier.add_gradient(gradient);
        f.contact.add_static_forces(x, force);
        EXPECT_GT(gradient.norm(), 0.0);
        EXPECT_LT((force + gradient).norm(), 1e-12 * gradient.norm()) << gap;
    }
}

TEST(XpbdSelfContact, ASweepWhereNothingMovesLeavesTheBarriersForces) {
    Fixture f(0.001);
    const Positions x = test::crumpled(f.mesh.rest_position, 0.0001);
    Positions at_rest = Positions::Zero(x.rows(), 3), swept = at_rest, moved = x;
    f.contact.add_static_forces(x, at_rest);
    const Eigen::VectorXd immovable = Eigen::VectorXd::Zero(x.rows());
    for (const bool keep : {true, false}) {
        f.contact.begin({1e-6, immovable}, 0.001, keep, x);
        f.contact.sweep({1e-6, immovable}, x, moved);
        swept.setZero();
        f.contact.add_forces(swept);
        EXPECT_LT((swept - at_rest).norm(), 1e-12 * at_rest.norm()) << keep;
    }
    EXPECT_EQ(moved, x);
}

TEST(XpbdSelfContact, NoStepEverCrosses) {
    for (const double speed : {0.1, 1.0, 10.0}) {
        Fixture f(0.004);
        XpbdState state = f.thrown(speed);
        f.system.self_contact = nullptr;
        XpbdState through = state;
        for (int k = 0; k < 60; ++k) through = xpbd_step(f.system, f.parameters, std::move(through));
        f.system.self_contact = &f.contact;
        for (int k = 0; k < 60; ++k) {
            state = xpbd_step(f.system, f.parameters, std::move(state));
            ASSERT_EQ(count_self_intersections(f.mesh.triangle, state.position), 0) << speed << " m/s, step " << k;
        }
        const Eigen::Index half = state.position.rows() / 2;
        EXPECT_LT(state.position.topRows(half).col(1).mean(), state.position.bottomRows(half).col(1).mean());
        // In 60 ms the layers meet, and without contact would be through each other.
        EXPECT_GT(through.position.topRows(half).col(1).mean(), through.position.bottomRows(half).col(1).mean());
    }
}

TEST(XpbdSelfContact, LinearMomentumIsKept) {
    Fixture f(0.0025);
    f.parameters.largest_move = 0.0;
    XpbdState state = f.thrown(0.2);
    const Eigen::RowVector3d before = f.mesh.mass.transpose() * state.velocity;
    double fastest = 0.0;
    for (int k = 0; k < 30; ++k) {
        state = xpbd_step(f.system, f.parameters, std::move(state));
        fastest = std::max(fastest, state.velocity.rowwise().norm().maxCoeff());
    }
    // Nothing was cut off by the search for collisions: repulsion alone has kept the layers apart.
    const Eigen::RowVector3d after = f.mesh.mass.transpose() * state.velocity;
    EXPECT_LT((after - before).norm(), 1e-9 * f.mesh.mass.sum() * 0.2);
    EXPECT_LT(fastest, 2.0);
}

TEST(XpbdSelfContact, AStepDoesNotDependOnStepsBefore) {
    Fixture seasoned(0.003);
    XpbdState state = seasoned.thrown(0.3);
    for (int k = 0; k < 20; ++k) {
        Fixture fresh(0.003);
        const XpbdState once = xpbd_step(fresh.system, fresh.parameters, state);
        state = xpbd_step(seasoned.system, seasoned.parameters, std::move(state));
        ASSERT_EQ(once.position, state.position) << k;
    }
}

/// The drape of two layers on a table.
DrapeResult stacked(const std::string& solver) {
    DrapeScene scene;
    scene.mesh = test::two_layers(0.0025, 4);
    scene.mesh.rest_position.col(1).array() += 0.0019;
    scene.bending = BendingOptions{};
    scene.contact = ContactOptions{};
    scene.self_contact = SelfContactOptions{.thickness = 0.002, .friction = 0.3};
    scene.table = TableOptions{};
    scene.ladder.tries = 0;
    scene.solver.solver = solver;
    scene.solver.residual_tolerance = 1e-5;
    return Draper(scene).drape_neutral();
}

TEST(XpbdSelfContact, LayersRestAsFarApartAsImplicits) {
    const DrapeResult implicit = stacked("implicit"), xpbd = stacked("xpbd");
    EXPECT_EQ(implicit.status, DrapeStatus::accepted) << status_reason(implicit.status);
    EXPECT_EQ(xpbd.status, DrapeStatus::accepted) << status_reason(xpbd.status);
    EXPECT_EQ(xpbd.certificate.self_intersections, 0);
    const auto gap = [](const DrapeResult& result) {
        const Eigen::Index half = result.position.rows() / 2;
        return result.position.bottomRows(half).col(1).mean() - result.position.topRows(half).col(1).mean();
    };
    EXPECT_GT(gap(implicit), 0.001);
    EXPECT_NEAR(gap(xpbd), gap(implicit), 1e-5);
}

}  // namespace
}  // namespace toile::simulate
