#pragma once

#include <Eigen/Geometry>
#include <random>

#include "cloth/cloth_mesh.h"

namespace toile::test {

/// A sheet of `n` x `n` squares, each cut in two, of side 1, with inner vertices moved about; `height` bends it into a
/// paraboloid.
inline ClothMesh sheet(int n, double height = 0.0) {
    ClothMesh mesh;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.2 / n, 0.2 / n);
    mesh.rest_position.resize((n + 1) * (n + 1), 3);
    for (int row = 0; row <= n; ++row) {
        for (int column = 0; column <= n; ++column) {
            const bool inner = row > 0 && row < n && column > 0 && column < n;
            const double x = 1.0 * column / n + (inner ? shift(random) : 0);
            const double y = 1.0 * row / n + (inner ? shift(random) : 0);
            mesh.rest_position.row(row * (n + 1) + column) << x, y,
                height * ((x - 0.5) * (x - 0.5) + 0.7 * (y - 0.5) * (y - 0.5));
        }
    }
    mesh.triangle.resize(2 * n * n, 3);
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) {
            const int a = row * (n + 1) + column, f = 2 * (row * n + column);
            mesh.triangle.row(f) << a, a + 1, a + n + 2;
            mesh.triangle.row(f + 1) << a, a + n + 2, a + n + 1;
        }
    }
    return mesh;
}

/// x -> A x + c for each vertex.
inline Positions mapped(const Positions& position, const Eigen::Matrix3d& a,
                        const Eigen::Vector3d& c = Eigen::Vector3d::Zero()) {
    return (position * a.transpose()).rowwise() + c.transpose();
}

/// Some rotation that favours no axis.
inline Eigen::Matrix3d turn(double angle = 1.1) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
}

}  // namespace toile::test
