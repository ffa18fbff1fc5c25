#pragma once

#include <cmath>

#include "cloth/cloth_mesh.h"

namespace toile::test {

/// A square of cloth in the plane y = `height`, side `side` [m], n x n cells with alternating diagonals. Outside is up.
inline ClothMesh cloth_square(int n, double side, double height, double density_per_area = 0.2) {
    ClothMesh mesh;
    const int row = n + 1;
    mesh.rest_position.resize(row * row, 3);
    mesh.pattern_position.resize(row * row, 2);
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            const double u = side * i / n, v = side * j / n;
            mesh.pattern_position.row(j * row + i) << u, v;
            mesh.rest_position.row(j * row + i) << u - 0.5 * side, height, 0.5 * side - v;
        }
    }
    mesh.triangle.resize(2 * n * n, 3);
    int f = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const int a = j * row + i, b = a + 1, c = a + row, d = c + 1;
            if ((i + j) % 2 == 0) {
                mesh.triangle.row(f++) << a, b, c;
                mesh.triangle.row(f++) << b, d, c;
            } else {
                mesh.triangle.row(f++) << a, b, d;
                mesh.triangle.row(f++) << a, d, c;
            }
        }
    }
    mesh.pattern_triangle = mesh.triangle;
    mesh.mass = lumped_mass(mesh, density_per_area);
    return mesh;
}

/// The same positions with every coordinate moved by up to `size`, without a seed: the same each time.
inline Positions crumpled(const Positions& x, double size) {
    Positions moved = x;
    for (Eigen::Index k = 0; k < moved.size(); ++k)
        moved.data()[k] += size * std::sin(12.9898 * static_cast<double>(k + 1));
    return moved;
}

inline Eigen::VectorXd flat(const Positions& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), x.size());
}
inline Positions rows(const Eigen::VectorXd& x) {
    return Eigen::Map<const Positions>(x.data(), x.size() / 3, 3);
}

}  // namespace toile::test
