#pragma once

#include "cloth/membrane.h"

namespace toile::test {

/// A triangle of a few centimetres, flat in the plane z = 0 as in its pattern, not aligned with warp and weft.
inline ClothMesh one_triangle() {
    ClothMesh mesh;
    mesh.triangle.resize(1, 3);
    mesh.triangle << 0, 1, 2;
    mesh.pattern_triangle = mesh.triangle;
    mesh.pattern_position.resize(3, 2);
    mesh.pattern_position << 0.1, 0.2, 0.13, 0.21, 0.11, 0.24;
    mesh.rest_position.resize(3, 3);
    for (int v = 0; v < 3; ++v) mesh.rest_position.row(v) << mesh.pattern_position.row(v), 0.0;
    return mesh;
}

/// The triangle under the deformation gradient whose columns are f_u and f_v.
inline TrianglePositions deformed_by(const ClothMesh& mesh, const Eigen::Vector3d& fu, const Eigen::Vector3d& fv) {
    TrianglePositions x;
    for (int v = 0; v < 3; ++v)
        x.col(v) =
            mesh.pattern_position(v, 0) * fu + mesh.pattern_position(v, 1) * fv + Eigen::Vector3d(0.3, -0.2, 0.1);
    return x;
}

inline Eigen::VectorXd flat(const TrianglePositions& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), 9);
}
inline TrianglePositions columns(const Eigen::VectorXd& x) {
    return Eigen::Map<const Eigen::Matrix3d>(x.data());
}

}  // namespace toile::test
