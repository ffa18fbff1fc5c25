#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "simulate/elasticity.h"
#include "tests/simulate/cloth_square.h"
#include "tests/support/derivative_checker.h"

namespace toile::simulate {
namespace {

struct Fixture {
    ClothMesh mesh = test::cloth_square(3, 0.06, 0.0);
    Topology topology = build_topology(mesh.triangle);
    Positions x = test::crumpled(mesh.rest_position, 0.002);
};

Eigen::MatrixXd dense(const BlockValues& matrix) {
    const int size = 3 * matrix.symbolic().vertex_count();
    Eigen::MatrixXd full(size, size);
    for (int k = 0; k < size; ++k) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, k);
        matrix.multiply(unit.data(), full.col(k).data());
    }
    return full;
}

/// Every kind of stencil at least once: what a scene may ask for.
std::vector<Elasticity> kinds(const Fixture& f) {
    const Eigen::Vector3d gravity(0.3, -9.81, 0.1);
    MembraneOptions wrinkling;
    wrinkling.compression = Compression::tension_field;
    const BendingOptions flat{0.01}, start{0.01, BendingRest::start};
    std::vector<Elasticity> kind;
    kind.emplace_back(f.mesh, f.topology, MembraneOptions{}, std::nullopt, gravity);
    kind.emplace_back(f.mesh, f.topology, MembraneOptions{}, flat, gravity);
    kind.emplace_back(f.mesh, f.topology, MembraneOptions{}, start, gravity);
    kind.emplace_back(f.mesh, f.topology, MembraneOptions{}, flat, gravity, StrainLimitOptions{1.02, 1.01});
    kind.emplace_back(f.mesh, f.topology, wrinkling, flat, gravity);
    return kind;
}

TEST(Elasticity, GradientIsTheEnergysDerivative) {
    Fixture f;
    f.mesh.rest_position = test::crumpled(f.mesh.rest_position, 0.004);
    for (const Elasticity& elasticity : kinds(f)) {
        Positions gradient = Positions::Zero(f.x.rows(), 3);
        elasticity.add_gradient(f.x, gradient);
        const auto energy = [&](const Eigen::VectorXd& at) { return elasticity.energy(test::rows(at)); };
        const auto check = test::check_gradient(energy, test::flat(gradient), test::flat(f.x), 0.02, 1e-6);
        EXPECT_TRUE(check.passed) << check.message;
    }
}

TEST(Elasticity, HessianIsSemidefiniteWhateverTheSceneAsksFor) {
    Fixture f;
    f.mesh.rest_position = test::crumpled(f.mesh.rest_position, 0.004);
    for (Elasticity& elasticity : kinds(f)) {
        const auto symbolic = std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), elasticity.pairs());
        elasticity.bind(*symbolic);
        for (const double size : {1.3, 0.5}) {
            BlockValues hessian(symbolic);
            elasticity.add_hessian(size * f.x, hessian);
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(hessian)).eigenvalues();
            EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
            EXPECT_GT(values.maxCoeff(), 0.0);
        }
    }
}

TEST(Elasticity, AStrainLimitStiffensOnlyBeyondIt) {
    const Fixture f;
    const Elasticity with(f.mesh, f.topology, {}, {}, {0, 0, 0}, StrainLimitOptions{1.1, 1.1}),
        without(f.mesh, f.topology, {}, {}, {0, 0, 0});
    EXPECT_EQ(with.energy(1.09 * f.mesh.rest_position), without.energy(1.09 * f.mesh.rest_position));
    EXPECT_GT(with.energy(1.12 * f.mesh.rest_position), 1.05 * without.energy(1.12 * f.mesh.rest_position));
}

TEST(Elasticity, HessianIsTheGradientsDerivativeInTension) {
    // Where nothing is compressed the projected Hessian is the true one.
    Fixture f;
    f.x = 1.3 * test::crumpled(f.mesh.rest_position, 0.0005);
    Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{0.01}, {0, -9.81, 0});
    BlockValues hessian(std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), elasticity.pairs()));
    elasticity.bind(hessian.symbolic());
    elasticity.add_hessian(f.x, hessian);
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        Positions g = Positions::Zero(f.x.rows(), 3);
        elasticity.add_gradient(test::rows(at), g);
        return test::flat(g);
    };
    const auto check = test::check_jacobian(gradient, dense(hessian), test::flat(f.x), 0.02, 1e-6);
    EXPECT_TRUE(check.passed) << check.message;
}

TEST(Elasticity, HessianIsPositiveSemidefiniteInCompression) {
    Fixture f;
    f.x = 0.7 * test::crumpled(f.mesh.rest_position, 0.002);
    Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{}, {0, -9.81, 0});
    BlockValues hessian(std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), elasticity.pairs()));
    elasticity.bind(hessian.symbolic());
    elasticity.add_hessian(f.x, hessian);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(hessian)).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
}

TEST(Elasticity, WeakBendingKeepsToTheMeshGraphAndBoundsTheTrueHessian) {
    Fixture f;
    f.x = 1.3 * test::crumpled(f.mesh.rest_position, 0.0005);
    Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{1e-6}, {0, -9.81, 0});
    BlockValues hessian(std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), elasticity.pairs()));
    EXPECT_EQ(hessian.symbolic().slot_count(), f.mesh.vertex_count() + f.topology.edge.rows());
    elasticity.bind(hessian.symbolic());
    elasticity.add_hessian(f.x, hessian);
    // The true one, by differences of the gradient, which is exact up to rounding for what is left out.
    Eigen::MatrixXd true_hessian(3 * f.x.rows(), 3 * f.x.rows());
    const Eigen::VectorXd at = test::flat(f.x);
    for (Eigen::Index k = 0; k < at.size(); ++k) {
        Positions ahead = Positions::Zero(f.x.rows(), 3), behind = ahead;
        elasticity.add_gradient(test::rows(at + 1e-6 * Eigen::VectorXd::Unit(at.size(), k)), ahead);
        elasticity.add_gradient(test::rows(at - 1e-6 * Eigen::VectorXd::Unit(at.size(), k)), behind);
        true_hessian.col(k) = test::flat(ahead - behind) / 2e-6;
    }
    const Eigen::MatrixXd excess = dense(hessian) - 0.5 * (true_hessian + true_hessian.transpose());
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(excess).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-6 * true_hessian.norm());
    EXPECT_GT(values.maxCoeff(), 0.0) << "something is on the diagonal instead";
}

TEST(Elasticity, WithoutBendingThereAreNoHinges) {
    const Fixture f;
    const Elasticity with(f.mesh, f.topology, {}, BendingOptions{0.01}, {0, 0, 0}),
        without(f.mesh, f.topology, {}, {}, {0, 0, 0});
    const BlockSymbolic wide(f.mesh.vertex_count(), with.pairs()), narrow(f.mesh.vertex_count(), without.pairs());
    EXPECT_LT(narrow.slot_count(), wide.slot_count());
    EXPECT_LT(without.energy(f.x), with.energy(f.x));
}

TEST(Elasticity, RestHasNoForceButWeight) {
    const Fixture f;
    const Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{}, {0, -9.81, 0});
    Positions gradient = Positions::Zero(f.x.rows(), 3);
    elasticity.add_gradient(f.mesh.rest_position, gradient);
    EXPECT_NEAR(gradient.col(1).sum(), 9.81 * f.mesh.mass.sum(), 1e-12);
    EXPECT_LT(gradient.col(0).norm() + gradient.col(2).norm(), 1e-9);
}

TEST(Elasticity, WithItsSofteningTheHessianIsTheGradientsDerivative) {
    // Weak bending, whose couplings across a hinge are not in the graph, and cloth that is pressed.
    const Fixture f;
    Elasticity elasticity(f.mesh, f.topology, {}, BendingOptions{1e-7}, {0, -9.81, 0});
    const auto symbolic = std::make_shared<const BlockSymbolic>(f.mesh.vertex_count(), elasticity.pairs());
    ASSERT_EQ(symbolic->pair().size(), static_cast<size_t>(f.topology.edge.rows())) << "bending is not weak";
    elasticity.bind(*symbolic);
    const Positions x = 0.97 * f.x;
    BlockValues hessian(symbolic);
    elasticity.add_hessian(x, hessian);
    std::vector<double> softening;
    elasticity.find_softening(x, softening);
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        Positions rows = Positions::Zero(x.rows(), 3);
        elasticity.add_gradient(test::rows(at), rows);
        return test::flat(rows);
    };
    Eigen::MatrixXd whole = dense(hessian), projected = whole;
    for (int k = 0; k < whole.cols(); ++k) {
        Positions product = test::rows(whole.col(k));
        elasticity.add_softened(softening, test::rows(Eigen::VectorXd::Unit(whole.cols(), k)), product);
        whole.col(k) = test::flat(product);
    }
    EXPECT_GT((whole - projected).norm(), 1e-3 * projected.norm());
    const auto check = test::check_jacobian(gradient, whole, test::flat(x), 0.02, 1e-6);
    EXPECT_TRUE(check.passed) << check.message;
}

}  // namespace
}  // namespace toile::simulate
