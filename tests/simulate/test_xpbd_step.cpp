#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "simulate/elasticity.h"
#include "simulate/obstacle.h"
#include "simulate/xpbd_step.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

struct Fixture {
    ClothMesh mesh = test::cloth_square(6, 0.3, 0.0);
    Topology topology = build_topology(mesh.triangle);
    MembraneOptions membrane;
    BendingOptions bending;

    XpbdSystem system(const Eigen::Vector3d& gravity) const {
        return {XpbdConstraints(mesh, topology, membrane, bending), {}, mesh.mass * gravity.transpose()};
    }
    XpbdParameters parameters(double time_step) const {
        XpbdParameters p;
        p.time_step = time_step;
        p.inverse_mass = mesh.mass.cwiseInverse();
        return p;
    }
    double energy(const XpbdState& state) const {
        const Elasticity elasticity(mesh, topology, membrane, bending, Eigen::Vector3d::Zero());
        return elasticity.energy(state.position) + 0.5 * mesh.mass.dot(state.velocity.rowwise().squaredNorm());
    }
    Eigen::RowVector3d momentum(const XpbdState& state) const { return mesh.mass.transpose() * state.velocity; }
    Eigen::RowVector3d angular_momentum(const XpbdState& state) const {
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        for (int v = 0; v < mesh.vertex_count(); ++v)
            sum += mesh.mass[v] * state.position.row(v).cross(state.velocity.row(v));
        return sum;
    }
};

TEST(XpbdStep, FreeFallIsExact) {
    const Fixture f;
    const XpbdSystem system = f.system({0, -9.81, 0});
    XpbdState state = system.state_at(f.mesh.rest_position);
    const XpbdParameters parameters = f.parameters(0.002);
    for (int k = 0; k < 50; ++k) state = xpbd_step(system, parameters, std::move(state));
    // Symplectic Euler: h² g (1 + 2 + … + 50).
    const Positions move = state.position - f.mesh.rest_position;
    EXPECT_LT((move.col(1).array() + 9.81 * 4e-6 * 1275).abs().maxCoeff(), 1e-12);
    EXPECT_LT(move.col(0).norm() + move.col(2).norm(), 1e-12);
    EXPECT_LT((state.velocity.col(1).array() + 0.981).abs().maxCoeff(), 1e-10);
}

TEST(XpbdStep, RestStaysAtRest) {
    const Fixture f;
    const XpbdSystem system = f.system(Eigen::Vector3d::Zero());
    XpbdState state = system.state_at(f.mesh.rest_position);
    for (int k = 0; k < 50; ++k) state = xpbd_step(system, f.parameters(0.002), std::move(state));
    EXPECT_LT((state.position - f.mesh.rest_position).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(XpbdStep, MomentaAreKeptWithoutForces) {
    Fixture f;
    f.bending.stiffness = 1e-4;
    const XpbdSystem system = f.system(Eigen::Vector3d::Zero());
    XpbdState state = system.state_at(test::crumpled(f.mesh.rest_position, 0.003));
    for (int v = 0; v < f.mesh.vertex_count(); ++v)
        state.velocity.row(v) = Eigen::RowVector3d(0.3, -0.2, 0.5) +
                                Eigen::RowVector3d(1.0, 2.0, -1.5).cross(state.position.row(v)) +
                                0.2 * std::sin(7.0 * v) * Eigen::RowVector3d(1.0, -1.0, 0.5);
    const Eigen::RowVector3d linear = f.momentum(state), angular = f.angular_momentum(state);
    for (int k = 0; k < 200; ++k) state = xpbd_step(system, f.parameters(2e-4), std::move(state));
    EXPECT_LT((f.momentum(state) - linear).norm(), 1e-9 * linear.norm());
    EXPECT_LT((f.angular_momentum(state) - angular).norm(), 1e-9 * angular.norm());
}

TEST(XpbdStep, EnergyNeverRisesUnderDamping) {
    for (const bool keep : {true, false}) {
        Fixture f;
        const XpbdSystem system = f.system(Eigen::Vector3d::Zero());
        XpbdState state = system.state_at(test::crumpled(f.mesh.rest_position, 0.002));
        XpbdParameters parameters = f.parameters(keep ? 5e-5 : 5e-4);
        parameters.damping = 20.0;
        parameters.keep_forces = keep;
        double before = f.energy(state);
        const double first = before;
        for (int k = 0; k < 100; ++k) {
            for (int small = 0; small < 10; ++small) state = xpbd_step(system, parameters, std::move(state));
            const double after = f.energy(state);
            EXPECT_LE(after, before + 1e-9 * first) << k << (keep ? " keeping forces" : "");
            before = after;
        }
        EXPECT_LT(before, 0.5 * first);
    }
}

TEST(XpbdStep, ForcesAreThoseOfTheEnergy) {
    // Where nothing can move, one sweep takes every constraint's force to the energy's.
    for (const Compression compression : {Compression::full, Compression::tension_field}) {
        Fixture f;
        f.membrane.compression = compression;
        Positions x = test::crumpled(f.mesh.rest_position, 0.02);
        x.topRows(21).col(0) *= 0.4;  // squeezed
        const Elasticity elasticity(f.mesh, f.topology, f.membrane, f.bending, Eigen::Vector3d::Zero());
        Positions gradient = Positions::Zero(x.rows(), 3), force = gradient;
        elasticity.add_gradient(x, gradient);
        const XpbdConstraints constraints(f.mesh, f.topology, f.membrane, f.bending);
        XpbdForces forces = constraints.no_forces();
        Positions moved = x;
        const Eigen::VectorXd immovable = Eigen::VectorXd::Zero(x.rows());
        constraints.sweep({1e-6, immovable}, x, forces, moved);
        constraints.begin({1e-6, immovable}, x, forces, force);
        EXPECT_LT((force + gradient).norm(), 1e-12 * gradient.norm());
        EXPECT_EQ(moved, x);
        EXPECT_EQ(forces.squeeze.norm() > 0.0, compression == Compression::full);
    }
}

TEST(XpbdStep, AFunctionOfItsArguments) {
    const Fixture f;
    const XpbdSystem system = f.system({0, -9.81, 0});
    const XpbdState start = system.state_at(test::crumpled(f.mesh.rest_position, 0.003));
    const XpbdState once = xpbd_step(system, f.parameters(0.001), start);
    xpbd_step(system, f.parameters(0.002), once);
    const XpbdState again = xpbd_step(system, f.parameters(0.001), start);
    EXPECT_EQ(once.position, again.position);
    EXPECT_EQ(once.velocity, again.velocity);
    EXPECT_EQ(once.forces.membrane, again.forces.membrane);
}

TEST(XpbdStep, DampingEnlargesTheMass) {
    const Fixture f;
    const XpbdSystem system = f.system({0, -9.81, 0});
    XpbdParameters parameters = f.parameters(0.01);
    parameters.damping = 50.0;
    const XpbdState state = xpbd_step(system, parameters, system.state_at(f.mesh.rest_position));
    // (1/h² + α/h) Δ = g, as in an implicit Euler step.
    EXPECT_NEAR((state.position - f.mesh.rest_position)(0, 1), -9.81 / (1e4 + 50.0 / 0.01), 1e-12);
}

TEST(XpbdStep, StaysFiniteHoweverStiffOrInverted) {
    for (const double scale : {1e-3, 1.0, 1e5}) {
        for (const bool keep : {true, false}) {
            Fixture f;
            f.membrane.warp_stiffness *= scale;
            f.membrane.weft_stiffness *= scale;
            f.membrane.shear_stiffness *= scale;
            f.bending.stiffness *= scale;
            const XpbdSystem system = f.system({0, -9.81, 0});
            Positions mirrored = test::crumpled(f.mesh.rest_position, 0.05);
            mirrored.col(0).head(mirrored.rows() / 2) *= -0.3;
            XpbdState state = system.state_at(mirrored);
            XpbdParameters parameters = f.parameters(0.0016);
            parameters.keep_forces = keep;
            parameters.inverse_mass[0] = 0.0;
            for (int k = 0; k < 200; ++k) state = xpbd_step(system, parameters, std::move(state));
            EXPECT_TRUE(state.position.allFinite()) << scale << " " << keep;
            EXPECT_EQ(state.position.row(0), mirrored.row(0));
            EXPECT_LT(state.position.cwiseAbs().maxCoeff(), 10.0) << scale << " " << keep;
        }
    }
}

TEST(XpbdStep, FrictionHoldsOnASlopeAndLetsGo) {
    // On a table with gravity turned aside, from where contact carries it: it stays up to a slope of the coefficient.
    Fixture f;
    f.mesh = test::cloth_square(2, 0.1, 0.00198);
    f.topology = build_topology(f.mesh.triangle);
    const Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{}, Eigen::Vector3d::Zero());
    const BlockSymbolic symbolic(f.mesh.vertex_count(), elasticity.pairs());
    const std::vector<ContactPoint> points = contact_points(f.mesh, f.topology, symbolic);
    const Table table(TableOptions{0.0});
    for (const double slope : {0.2, 0.4}) {
        Contact contact({0.002, 0.3}, 2e4, points, table);
        contact.begin_step(f.mesh.rest_position);
        XpbdSystem system = f.system({9.81 * slope, -9.81, 0});
        system.contacts.emplace_back(contact);
        XpbdState state = system.state_at(f.mesh.rest_position);
        system.contacts[0].tie(true, state.touches[0]);
        for (int k = 0; k < 1000; ++k) state = xpbd_step(system, f.parameters(0.001), std::move(state));
        const double slid = (state.position - f.mesh.rest_position).col(0).mean();
        if (slope < 0.3) {
            EXPECT_LT(std::abs(slid), 0.001);
        } else {
            // ½ (0.4 − 0.3) g t² after a second.
            EXPECT_NEAR(slid, 0.5 * 0.1 * 9.81, 0.05);
        }
        EXPECT_GT(state.position.col(1).minCoeff(), 0.0);
    }
}

}  // namespace
}  // namespace toile::simulate
