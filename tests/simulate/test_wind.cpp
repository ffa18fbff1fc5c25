#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "simulate/wind.h"
#include "tests/simulate/cloth_square.h"

namespace toile::simulate {
namespace {

/// A square of 0.25 m² across the vertical, turned by `angle` about x.
Positions tilted(const ClothMesh& mesh, double angle) {
    Positions x = mesh.rest_position;
    x.col(1) = std::sin(angle) * mesh.rest_position.col(2);
    x.col(2) = std::cos(angle) * mesh.rest_position.col(2);
    return x;
}

TEST(Wind, PushesAPlateAcrossItByTheDragFormula) {
    const ClothMesh mesh = test::cloth_square(4, 0.5, 0.0);
    Wind wind(mesh, {{0, 5, 0}, 1.1, 0.7, 1.2});
    wind.linearise(mesh.rest_position);
    const Eigen::RowVector3d total = wind.force().colwise().sum();
    EXPECT_NEAR(total.y(), 0.5 * 1.2 * 0.25 * 25.0 * 1.1, 1e-12);
    EXPECT_NEAR(std::hypot(total.x(), total.z()), 0.0, 1e-12);
}

TEST(Wind, EqualCoefficientsMakeAPressure) {
    const ClothMesh mesh = test::cloth_square(4, 0.5, 0.0);
    Wind wind(mesh, {{0, 5, 0}, 1.2, 1.2, 1.2});
    for (const double angle : {0.3, 1.0, -0.8}) {
        wind.linearise(tilted(mesh, angle));
        const Eigen::Vector3d total = wind.force().colwise().sum().transpose();
        const Eigen::Vector3d normal(0, std::cos(angle), -std::sin(angle));
        EXPECT_LT(total.cross(normal).norm(), 1e-12);
        EXPECT_NEAR(total.dot(normal), 0.5 * 1.2 * 0.25 * 25.0 * 1.2 * std::cos(angle), 1e-12);
    }
}

TEST(Wind, DragActsAlongItAndLiftAcross) {
    const ClothMesh mesh = test::cloth_square(4, 0.5, 0.0);
    Wind drag(mesh, {{0, 4, 0}, 1.0, 0.0, 1.2}), lift(mesh, {{0, 4, 0}, 0.0, 1.0, 1.2});
    drag.linearise(tilted(mesh, 0.6));
    lift.linearise(tilted(mesh, 0.6));
    EXPECT_LT(drag.force().leftCols<1>().norm() + drag.force().rightCols<1>().norm(), 1e-12);
    EXPECT_LT(lift.force().col(1).norm(), 1e-12);
    EXPECT_GT(lift.force().norm(), 0.1);
}

TEST(Wind, ItIsTheVelocityRelativeToTheClothThatCounts) {
    const ClothMesh mesh = test::cloth_square(4, 0.5, 0.0);
    Positions velocity = Positions::Zero(mesh.vertex_count(), 3);
    velocity.col(1).setConstant(3.0);
    Wind moving(mesh, {{0, 5, 0}}), still(mesh, {{0, 2, 0}});
    moving.linearise(mesh.rest_position, &velocity);
    still.linearise(mesh.rest_position);
    EXPECT_LT((moving.force() - still.force()).norm(), 1e-12);
    velocity.col(1).setConstant(5.0);
    moving.linearise(mesh.rest_position, &velocity);
    EXPECT_EQ(moving.force().norm(), 0.0) << "carried along";
}

TEST(Wind, EnergyAndGradientAreThoseOfAConstantForce) {
    const ClothMesh mesh = test::cloth_square(2, 0.5, 0.0);
    Wind wind(mesh, {});
    wind.linearise(test::crumpled(mesh.rest_position, 0.05));
    Positions gradient = Positions::Zero(mesh.vertex_count(), 3), moved = mesh.rest_position;
    wind.add_gradient(gradient);
    moved(3, 2) += 0.1;
    EXPECT_NEAR(wind.energy(moved) - wind.energy(mesh.rest_position), 0.1 * gradient(3, 2), 1e-15);
}

}  // namespace
}  // namespace toile::simulate
