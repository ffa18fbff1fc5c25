#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloth/types.h"

namespace toile::pattern {

/// A closed curve in a plane, counter-clockwise, walked by arc length: what a tape measure lies along.
class TapeLoop {
  public:
    TapeLoop() = default;
    /// The convex hull of `points`, moved outwards by `offset` [m].
    TapeLoop(const std::vector<Eigen::Vector2d>& points, double offset);

    double length() const { return arc_.empty() ? 0.0 : arc_.back(); }
    /// The point at arc length `s` [m] from the start, modulo the length.
    Eigen::Vector2d at(double s) const;
    /// Arc length where the ray from `from` in `direction` leaves the loop; `from` must lie inside.
    double leaves_at(const Eigen::Vector2d& from, const Eigen::Vector2d& direction) const;
    const std::vector<Eigen::Vector2d>& corner() const { return corner_; }

  private:
    std::vector<Eigen::Vector2d> corner_;  // the first one is repeated at the end
    std::vector<double> arc_;              // arc length at each corner
};

/// Convex hull of points in a plane, counter-clockwise, without repetition; empty for fewer than three points.
std::vector<Eigen::Vector2d> convex_hull(const std::vector<Eigen::Vector2d>& points);

/// Points where the edges of those triangles cross the plane through `origin` with this normal, two a triangle.
std::vector<Eigen::Vector3d> plane_section(const Triangles& triangle, const Positions& position,
                                           const Eigen::Vector3d& origin, const Eigen::Vector3d& normal);

}  // namespace toile::pattern
