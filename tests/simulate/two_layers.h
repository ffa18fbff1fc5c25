#pragma once

#include <Eigen/Geometry>

#include "tests/simulate/cloth_square.h"

namespace toile::test {

/// Two squares of cloth, n x n cells and `side` [m], the second one `gap` above the first, turned a little so that
/// edges cross edges. The first square's vertices come first.
inline ClothMesh two_layers(double gap, int n = 5, double side = 0.1) {
    const ClothMesh one = cloth_square(n, side, 0.0);
    const int count = one.vertex_count();
    ClothMesh mesh;
    mesh.rest_position.resize(2 * count, 3);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
    mesh.rest_position.topRows(count) = one.rest_position;
    mesh.rest_position.bottomRows(count) = one.rest_position * turn.transpose();
    mesh.rest_position.bottomRows(count).col(1).array() += gap;
    mesh.pattern_position.resize(2 * count, 2);
    mesh.pattern_position << one.pattern_position, one.pattern_position;
    mesh.triangle.resize(2 * one.triangle_count(), 3);
    mesh.triangle << one.triangle, one.triangle.array() + count;
    mesh.pattern_triangle = mesh.triangle;
    mesh.mass = lumped_mass(mesh, 0.2);
    return mesh;
}

}  // namespace toile::test
