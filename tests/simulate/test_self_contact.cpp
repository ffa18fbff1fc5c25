#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "simulate/self_contact.h"
#include "simulate/self_intersection.h"
#include "tests/simulate/cloth_square.h"
#include "tests/simulate/two_layers.h"
#include "tests/support/derivative_checker.h"

namespace toile::simulate {
namespace {

constexpr double pressure = 2e4;

struct Layers {
    ClothMesh mesh;
    Topology topology;
    Positions x;

    explicit Layers(double gap, int n = 5)
        : mesh(test::two_layers(gap, n)),
          topology(build_topology(mesh.triangle)),
          x(test::crumpled(mesh.rest_position, 0.1 * gap)) {}
    SelfContact contact(double friction = 0.0) const {
        return {mesh, topology, {.thickness = 0.002, .friction = friction}, pressure};
    }
};

TEST(SelfContact, ClothAtRestDoesNotTouchItselfAcrossSlivers) {
    // Two of the grid's lines a thousandth of a cell apart: edges on either side of the strip are that near to each
    // other.
    ClothMesh mesh = test::cloth_square(6, 0.3, 0.0);
    const Topology topology = build_topology(mesh.triangle);
    const auto touching = [&] {
        SelfContact contact(mesh, topology, {.thickness = 0.002, .friction = 0.0}, pressure);
        contact.begin_step(mesh.rest_position, 0.01);
        contact.look_around(mesh.rest_position);
        contact.linearise(mesh.rest_position);
        return contact.touching().size();
    };
    EXPECT_EQ(touching(), 0u);
    for (int i = 0; i <= 6; ++i) {
        mesh.pattern_position(7 * 3 + i, 1) = mesh.pattern_position(7 * 2 + i, 1) + 5e-5;
        mesh.rest_position(7 * 3 + i, 2) = mesh.rest_position(7 * 2 + i, 2) - 5e-5;
    }
    EXPECT_EQ(touching(), 0u) << "apart as far as at rest";
    // Folded over along the strip, it does.
    for (int v = 7 * 4; v < mesh.vertex_count(); ++v) {
        const double beyond = mesh.rest_position(7 * 3, 2) - mesh.rest_position(v, 2);
        mesh.rest_position(v, 1) = 2e-5;
        mesh.rest_position(v, 2) = mesh.rest_position(7 * 3, 2) + beyond;
    }
    EXPECT_GT(touching(), 0u);
}

TEST(SelfContact, GradientIsTheEnergysDerivative) {
    for (const double gap : {0.0015, 0.0002, 0.00006}) {
        for (const double slide : {0.0, 1e-6, 1e-3}) {
            const Layers f(gap);
            SelfContact contact = f.contact(0.5);
            Positions before = f.x;
            before.topRows(f.x.rows() / 2).col(0).array() += slide;
            contact.begin_step(before, 0.01);
            contact.look_around(f.x);
            contact.linearise(f.x);
            ASSERT_FALSE(contact.touching().empty());
            Positions gradient = Positions::Zero(f.x.rows(), 3);
            contact.add_gradient(gradient);
            const auto energy = [&](const Eigen::VectorXd& at) { return contact.energy(test::rows(at)); };
            const auto check = test::check_gradient(energy, test::flat(gradient), test::flat(f.x), 0.02 * gap, 1e-5);
            EXPECT_TRUE(check.passed) << "gap " << gap << ", slide " << slide << ": " << check.message;
        }
    }
}

TEST(SelfContact, ForcesAddUpToNothingAndPushApart) {
    const Layers f(0.0005);
    SelfContact contact = f.contact();
    contact.begin_step(f.x, 0.01);
    contact.look_around(f.x);
    contact.linearise(f.x);
    Positions gradient = Positions::Zero(f.x.rows(), 3);
    contact.add_gradient(gradient);
    const Eigen::Index half = f.x.rows() / 2;
    EXPECT_LT(gradient.colwise().sum().norm(), 1e-9 * gradient.norm());
    EXPECT_GT(gradient.topRows(half).col(1).sum(), 0.0) << "the lower layer is pushed down";
    EXPECT_LT(gradient.bottomRows(half).col(1).sum(), 0.0);
}

TEST(SelfContact, LayersFurtherApartThanTheThicknessFeelNothing) {
    const Layers f(0.003);
    SelfContact contact = f.contact();
    contact.begin_step(f.x, 0.01);
    contact.look_around(f.x);
    contact.linearise(f.x);
    EXPECT_TRUE(contact.touching().empty());
    EXPECT_EQ(contact.energy(f.x), 0.0);
}

TEST(SelfContact, AFineMeshAtRestDoesNotTouchItself) {
    const ClothMesh mesh = test::cloth_square(12, 0.012, 0.0);  // edges of 1 mm, a thickness of 2
    const Topology topology = build_topology(mesh.triangle);
    SelfContact contact(mesh, topology, {.thickness = 0.002, .friction = 0.0}, pressure);
    contact.begin_step(mesh.rest_position, 0.01);
    contact.look_around(mesh.rest_position);
    contact.linearise(mesh.rest_position);
    EXPECT_TRUE(contact.touching().empty());
}

TEST(SelfContact, HessianIsPositiveSemidefinite) {
    const Layers f(0.0005, 3);
    SelfContact contact = f.contact(0.5);
    contact.begin_step(test::crumpled(f.x, 1e-4), 0.01);
    contact.look_around(f.x);
    contact.linearise(f.x);
    std::vector<std::pair<int, int>> pairs;
    for (const auto& point : contact.touching())
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j) pairs.emplace_back(point[i], point[j]);
    const auto size = static_cast<int>(f.x.size());
    BlockValues hessian(std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), pairs));
    contact.add_hessian(hessian);
    Eigen::MatrixXd full(size, size);
    for (int k = 0; k < size; ++k) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, k);
        hessian.multiply(unit.data(), full.col(k).data());
    }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
    EXPECT_GT(values.maxCoeff(), 0.0);
}

TEST(SelfContact, AMotionThatWouldCrossIsShortenedWhereItWould) {
    const Layers f(0.004);
    SelfContact contact = f.contact();
    const Eigen::Index half = f.x.rows() / 2;
    Positions motion = Positions::Zero(f.x.rows(), 3);
    for (Eigen::Index v = 0; v < half; ++v)  // one side of the lower layer up and through, the other down
        motion(v, 1) = f.x(v, 0) > 0.0 ? 0.02 : -0.02;
    Positions safe = motion;
    const double least = contact.limit(f.x, safe);
    EXPECT_GT(count_self_intersections(f.mesh.triangle, f.x + motion), 0) << "the test must be able to fail";
    EXPECT_EQ(count_self_intersections(f.mesh.triangle, f.x + safe), 0);
    EXPECT_LT(least, 0.3);
    EXPECT_GT(least, 0.05) << "it may go most of the way";
    EXPECT_GT(safe.row(0).norm(), 2.0 * least * motion.row(0).norm()) << "a corner that goes down";
    Positions alike = motion;
    const double share = contact.limit_alike(f.x, alike);
    EXPECT_LT((alike - share * motion).norm(), 1e-15);
    EXPECT_EQ(count_self_intersections(f.mesh.triangle, f.x + alike), 0);
}

TEST(SelfContact, NoSeriesOfWildMotionsEverCrosses) {
    Layers f(0.002, 8);
    SelfContact contact = f.contact();
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 30; ++k) {
        Positions motion(f.x.rows(), 3);
        const double size = std::pow(10.0, -1.0 - k % 4);  // 10 cm to a tenth of a millimetre
        // Layers that move together, and each vertex a little on its own.
        const Eigen::RowVector3d common(size * normal(random), size * normal(random), size * normal(random));
        for (Eigen::Index i = 0; i < motion.size(); ++i) motion.data()[i] = 0.3 * size * normal(random);
        motion.rowwise() += common;
        contact.begin_step(f.x, 0.01);
        contact.look_around(f.x);
        contact.linearise(f.x);
        contact.limit(f.x, motion);
        f.x += motion;
        ASSERT_EQ(count_self_intersections(f.mesh.triangle, f.x), 0) << "after motion " << k;
    }
}

}  // namespace
}  // namespace toile::simulate
