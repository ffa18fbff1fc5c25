#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cloth/topology.h"
#include "cloth/types.h"
#include "simulate/box_tree.h"
#include "simulate/proximity.h"

namespace toile::simulate {

/// A vertex and a triangle that may touch, with the indices of the four vertices in the order of `FourPoints`.
struct VertexTrianglePair {
    int vertex, triangle;
    std::array<int, 4> point;
    bool operator==(const VertexTrianglePair&) const = default;
};

/// Two edges that may touch, the smaller index first.
struct EdgeEdgePair {
    int first, second;
    std::array<int, 4> point;
    bool operator==(const EdgeEdgePair&) const = default;
};

/// In lexicographic order of the two indices; no pair twice, none that shares a vertex.
struct CandidatePairs {
    std::vector<VertexTrianglePair> vertex_triangle;
    std::vector<EdgeEdgePair> edge_edge;
};

/// Rows of a `[V x 3]` array.
inline FourPoints gather(const Positions& x, const std::array<int, 4>& point) {
    return {x.row(point[0]).transpose(), x.row(point[1]).transpose(), x.row(point[2]).transpose(),
            x.row(point[3]).transpose()};
}

/// Broad phase of self-contact: which vertices and triangles, edges and edges of one mesh are near each other. Keeps
/// the mesh and its work space, but nothing of earlier searches: what it finds depends on the arguments alone. Any mix
/// of triangle sizes and shapes will do; time grows as V log V plus the number of boxes that overlap. Features at
/// vertices that are not finite are found by their other vertices only.
///
///     ContactCandidates candidates(mesh.triangle, topology.edge);
///     CandidatePairs pairs;                                  // keep it: its memory is used again
///     candidates.find(x, thickness, pairs);
///     for (const auto& pair : pairs.edge_edge) edge_edge_proximity(gather(x, pair.point));
class ContactCandidates {
  public:
    ContactCandidates(const Triangles& triangle, const Edges& edge);

    /// Lets features differ: two are then near each other within the search's radius plus the lesser of their two
    /// reaches [m], one for each vertex, triangle and edge. So fine parts of a mesh can have less than coarse ones.
    void set_reach(const Eigen::VectorXd& vertex, const Eigen::VectorXd& triangle, const Eigen::VectorXd& edge);

    /// All pairs nearer than `radius` [m] at x `[V x 3]`; none that is further away, but for rounding. Throws `Error`
    /// where x has not as many rows as the mesh has vertices, or the radius is negative or not a number.
    void find(const Positions& x, double radius, CandidatePairs& pairs);

    /// All pairs that may come nearer than `radius` while x moves to x + motion, and some that don't: a pair is left
    /// out where its boxes, or the plane between its nearest points at x, tell.
    void find(const Positions& x, const Positions& motion, double radius, CandidatePairs& pairs);

    /// The same for the largest of 1, 1/2, 1/4, ... of the motion in which at most `most` boxes of either kind overlap,
    /// which is returned: a motion that is large against the mesh would make all pairs candidates, and fill the memory.
    /// Below 2^-20, where it isn't the motion, there is no bound.
    double find_bounded(const Positions& x, const Positions& motion, double radius, long most, CandidatePairs& pairs);

  private:
    static constexpr double least_share = 0x1p-20;

    void check(const Positions& x, double radius) const;
    void make_boxes(const Positions& x, const Positions* motion, double radius);
    // Keep decides on two features' four points. False where more than `most` boxes overlap.
    template <typename Keep>
    bool find_vertex_triangle(const Keep& keep, double radius, long most, std::vector<VertexTrianglePair>& pairs);
    template <typename Keep>
    bool find_edge_edge(const Keep& keep, double radius, long most, std::vector<EdgeEdgePair>& pairs);

    Triangles triangle_;
    Edges edge_;
    int vertex_count_;
    Eigen::VectorXd vertex_reach_, triangle_reach_, edge_reach_;
    std::vector<Box> vertex_box_, box_;
    BoxTree vertex_tree_, triangle_tree_, edge_tree_;
    std::vector<std::uint64_t> found_;  // first index, second index
};

}  // namespace toile::simulate
