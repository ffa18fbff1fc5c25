#pragma once

#include <Eigen/Core>
#include <vector>

namespace toile {

/// Positions in space, `[V x 3]`, row-major so that a row is a point and the memory is what HDF5 stores. [m]
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Positions in a plane, `[P x 2]`. [m]
using PlanePositions = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
/// Vertex indices of triangles, `[F x 3]`, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Vertex indices of edges, `[E x 2]`, the smaller index first.
using Edges = Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>;

}  // namespace toile
