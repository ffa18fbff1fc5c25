#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "simulate/contours.h"
#include "simulate/surface_pieces.h"

namespace toile::simulate {

/// Where the line of an edge passes through a triangle's plane.
struct Passage {
    Eigen::Vector3d normal;        ///< of the triangle, unit; zero for one without area
    Eigen::Vector3d point_weight;  ///< barycentric, of the passage clamped to the triangle
    double along;                  ///< the edge, from its first end, in [0, 1]
    Eigen::Vector2d height;        ///< of the edge's ends over the plane [m]
};

Passage passage(const Triangles& triangle, const Topology& topology, const Crossing& crossing, const Positions& x);

/// Moves the vertices of crossing edges and triangles so that less crosses.
///
/// A contour that cuts a piece off its surface tells which ends of its edges went through: those on the piece (Baraff,
/// Witkin, Kass: Untangling cloth, 2003, section 3). They are pushed back through the triangle. An edge that a contour
/// crosses twice, at two neighbouring triangles, has the edge between them on its wrong side, and changes places with
/// it. Where a contour ends at borders and cuts nothing off, one sheet has to come to lie on either side of the other:
/// the side that takes the shorter way. What is left moves in the direction that shortens its contour most (Volino,
/// Magnenat-Thalmann: Resolving surface collisions through intersection contour minimization, 2006).
class ContourPush {
  public:
    /// All must outlive the object. Vertices that are not `free` do not move.
    ContourPush(const Triangles& triangle, const Topology& topology, const VertexRing& ring,
                const std::vector<bool>& free);

    /// One pass over the crossings of x in order. No push is longer than `step` [m]; what was pushed through is left
    /// `separation` [m] away.
    void push(const std::vector<Crossing>& crossing, double step, double separation, Positions& x);
    /// Of each vertex: whether the last pass moved it.
    const std::vector<bool>& pushed() const { return pushed_; }

  private:
    enum class Way { first_end, second_end, swap, done, shorten };  // what to move, and how
    struct Plan {
        Way way = Way::shorten;
        int other_edge = -1;  // to swap with, and the points to bring past each other
        double along = 0.0, along_other = 0.0;
        Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    };
    using Weights = std::vector<std::pair<int, double>>;

    void plan(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x);
    void plan_swaps(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x);
    Plan swap_with(int edge, int other, const Positions& x) const;
    void plan_shorter_way(const std::vector<Crossing>& crossing, const Contour& contour, const Positions& x);
    void push_out(const Crossing& crossing, int inner, Positions& x);
    void swap(const Crossing& crossing, const Plan& plan, Positions& x);
    void shorten(const Crossing& crossing, Positions& x);
    void move_apart(const Weights& weights, const Eigen::Vector3d& by, Positions& x);

    const Triangles& triangle_;
    const Topology& topology_;
    const std::vector<bool>& free_;
    std::vector<int> component_;
    SurfacePieces pieces_;
    std::vector<bool> pushed_;
    std::vector<Plan> plan_;  // of each crossing
    double step_ = 0.0, separation_ = 0.0;
};

}  // namespace toile::simulate
