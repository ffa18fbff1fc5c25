#pragma once

#include <vector>

#include "cloth/types.h"

namespace toile {

/// Edges of a triangle mesh and what meets at them. Edge order is lexicographic in the two vertex indices, so it
/// depends on the triangles alone.
struct Topology {
    Edges edge;                                                ///< `[E x 2]`
    Eigen::Matrix<int, -1, 2, Eigen::RowMajor> edge_triangle;  ///< `[E x 2]` adjacent triangles, -1 where there is none
    Eigen::Matrix<int, -1, 3, Eigen::RowMajor> triangle_edge;  ///< `[F x 3]` edge opposite each corner
    int non_manifold_edge = -1;                                ///< the first edge with more than two triangles, or -1
};

Topology build_topology(const Triangles& triangle);

/// Closed chains of boundary edges, each a list of vertices in order along the boundary (the mesh to the left of each
/// edge).
std::vector<std::vector<int>> boundary_loops(const Triangles& triangle);

/// Hinges `[H x 4]`: shared edge (a, b), then the opposite vertices (c, d) of its two triangles.
Eigen::Matrix<int, -1, 4, Eigen::RowMajor> build_hinges(const Topology& topology, const Triangles& triangle);

/// Component index of each vertex, 0 for the component of vertex 0; an isolated vertex is a component of its own.
std::vector<int> connected_components(const Triangles& triangle, int vertex_count);

/// Unit vertex normals `[V x 3]`, each the angle-weighted mean of its triangles' normals; zero where it has no
/// triangle.
Positions vertex_normals(const Triangles& triangle, const Positions& position);

}  // namespace toile
