#pragma once

#include <Eigen/Core>
#include <string>

#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"

namespace toile::prior {

/// Pairs of triangles that share an edge, as (a, b, c, d): the edge, then the vertices opposite to it.
using Hinges = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// What the priors need of a garment's mesh, whatever it looks like: several components, isolated vertices, edges with
/// more than two triangles and inconsistent winding are welcome.
struct RestState {
    int vertex_count = 0;
    Edges edge;                         ///< `[E x 2]`, lexicographic
    Eigen::VectorXd edge_rest_length;   ///< `[E]` [m], all positive; the mean of an edge's pattern lengths over its
                                        ///< triangles, or its length in the rest position where there is no pattern
    Eigen::VectorXd mass;               ///< `[V]` [kg], all positive
    Hinges hinge;                       ///< `[H x 4]`: every pair of triangles at an edge; c != d
    Eigen::VectorXd hinge_rest_length;  ///< `[H]` [m] distance of c and d with both triangles unfolded into one plane,
                                        ///< by the rest lengths of their edges; 0 where c falls on d
    /// `[H x 2]` (u, v): where, in that plane, the line a-b meets the line c-d: (1-u) a + u b = (1-v) c + v d. Always
    /// 0 <= v <= 1; u lies outside [0, 1] where c-d passes beside the edge (clamping it would pull at the flat state).
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> hinge_crossing;
};

/// `mesh` may come without pattern (both pattern members empty) and without mass (empty: uniform density of 1 kg/m^2,
/// a third of each adjacent triangle's area, pattern area where there is a pattern). A vertex without triangles gets
/// the mean mass unless `mesh` says otherwise, and so does one whose triangles have no area. Throws Error, naming the
/// first offender and `where`, for: indices out of range, positions that are not finite, a triangle that names a vertex
/// twice, an edge of zero rest length, a mass that is negative, not finite, or zero at a vertex with triangles, a mesh
/// without vertices, pattern triangles that do not fit the triangles, an edge of more than a hundred triangles.
RestState rest_state(const ClothMesh& mesh, const std::string& where = {});

}  // namespace toile::prior
