#include <gtest/gtest.h>

#include "simulate/contact.h"
#include "tests/simulate/cloth_square.h"
#include "tests/support/derivative_checker.h"

namespace toile::simulate {
namespace {

/// A small square that dips into a sphere: some points touch, some do not.
struct Fixture {
    ClothMesh mesh = test::cloth_square(4, 0.08, 0.0);
    Topology topology = build_topology(mesh.triangle);
    BlockSymbolic symbolic{mesh.vertex_count(), pairs()};
    std::vector<ContactPoint> points = contact_points(mesh, topology, symbolic);
    Sphere sphere{SphereOptions{{0.003, -0.0991, 0.001}, 0.1}};
    Positions x = test::crumpled(mesh.rest_position, 0.0003);

    std::vector<std::pair<int, int>> pairs() const {
        std::vector<std::pair<int, int>> list;
        for (int e = 0; e < topology.edge.rows(); ++e) list.emplace_back(topology.edge(e, 0), topology.edge(e, 1));
        return list;
    }
};

TEST(Contact, PointsShareTheClothsArea) {
    const Fixture f;
    double area = 0.0;
    for (const ContactPoint& point : f.points) area += point.area;
    EXPECT_NEAR(area, 0.08 * 0.08, 1e-12);
}

TEST(Contact, GradientIsTheEnergysDerivativeSlidingAndSticking) {
    for (const double slide : {0.0, 1e-5, 0.003}) {
        Fixture f;
        Contact contact({0.002, 0.4}, 2e4, f.points, f.sphere);
        contact.begin_step(f.x);
        contact.linearise(f.x);  // anchors here
        f.x.rowwise() += Eigen::RowVector3d(slide, 0.0, 0.5 * slide);
        contact.linearise(f.x);
        Positions gradient = Positions::Zero(f.x.rows(), 3);
        contact.add_gradient(gradient);
        const auto energy = [&](const Eigen::VectorXd& at) { return contact.energy(test::rows(at)); };
        const auto check = test::check_gradient(energy, test::flat(gradient), test::flat(f.x), 1e-3, 1e-5);
        EXPECT_TRUE(check.passed) << "slide " << slide << ": " << check.message;
    }
}

TEST(Contact, NothingHappensFurtherAwayThanTheThickness) {
    Fixture f;
    Contact contact({0.002, 0.4}, 2e4, f.points, f.sphere);
    f.x.col(1).array() += 0.01;
    contact.begin_step(f.x);
    contact.linearise(f.x);
    Positions gradient = Positions::Zero(f.x.rows(), 3);
    contact.add_gradient(gradient);
    EXPECT_EQ(gradient.norm(), 0.0);
    EXPECT_EQ(contact.energy(f.x), 0.0);
}

TEST(Contact, FrictionNeverExceedsCoulomb) {
    // A flat table: the horizontal force is friction alone, the vertical one is the normal force.
    Fixture f;
    const Table table(TableOptions{-0.001});
    f.x = f.mesh.rest_position;
    for (const double friction : {0.0, 0.2, 0.7}) {
        Contact contact({0.002, friction}, 2e4, f.points, table);
        contact.begin_step(f.x);
        contact.linearise(f.x);
        Positions slid = f.x;
        slid.col(0).array() += 0.01;
        contact.linearise(slid);
        Positions gradient = Positions::Zero(f.x.rows(), 3);
        contact.add_gradient(gradient);
        EXPECT_NEAR(gradient.col(0).sum(), -friction * gradient.col(1).sum(), 1e-9)
            << "sliding: force at the cone's edge";
    }
}

TEST(Contact, AStickingPointIsPulledBack) {
    Fixture f;
    const Table table(TableOptions{-0.001});
    f.x = f.mesh.rest_position;
    Contact contact({0.002, 0.5}, 2e4, f.points, table);
    contact.begin_step(f.x);
    contact.linearise(f.x);
    Positions moved = f.x;
    moved.col(0).array() += 1e-6;
    contact.linearise(moved);
    contact.end_step(moved);
    contact.begin_step(moved);
    contact.linearise(moved);
    Positions gradient = Positions::Zero(f.x.rows(), 3);
    contact.add_gradient(gradient);
    EXPECT_GT(gradient.col(0).sum(), 0.0);
    EXPECT_LT(gradient.col(0).sum(), 0.5 * -gradient.col(1).sum());
}

/// All space outside a ball: hollow everywhere.
class Hollow final : public Obstacle {
  public:
    Hollow(const Eigen::Vector3d& center, double radius) : center_(center), radius_(radius) {}
    Contact sample(const Eigen::Vector3d& point, int /*piece*/) const override {
        const Eigen::Vector3d out = point - center_;
        return {radius_ - out.norm(), -out.normalized()};
    }
    Eigen::Matrix3d curvature(const Eigen::Vector3d& point, int /*piece*/) const override {
        const Eigen::Vector3d n = (point - center_).normalized();
        return (n * n.transpose() - Eigen::Matrix3d::Identity()) / (point - center_).norm();
    }

  private:
    Eigen::Vector3d center_;
    double radius_;
};

TEST(Contact, HessianIsTheGradientsDerivativeInAHollow) {
    Fixture f;
    const Hollow hollow({0.0, 0.05, 0.0}, 0.051);
    Contact contact({0.002, 0.0}, 2e4, f.points, hollow);
    contact.begin_step(f.x);
    contact.linearise(f.x);
    BlockValues hessian(std::make_shared<const BlockSymbolic>(f.symbolic));
    contact.add_hessian(hessian);
    const auto size = static_cast<int>(f.x.size());
    Eigen::MatrixXd whole(size, size);
    for (int k = 0; k < size; ++k) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, k);
        hessian.multiply(unit.data(), whole.col(k).data());
    }
    EXPECT_GT(whole.norm(), 0.0);
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        Positions rows = Positions::Zero(f.x.rows(), 3);
        contact.linearise(test::rows(at));
        contact.add_gradient(rows);
        return test::flat(rows);
    };
    const auto check = test::check_jacobian(gradient, whole, test::flat(f.x), 1e-4, 1e-5);
    EXPECT_TRUE(check.passed) << check.message;
}

}  // namespace
}  // namespace toile::simulate
