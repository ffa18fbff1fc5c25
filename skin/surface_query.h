#pragma once

#include <Eigen/Core>
#include <memory>

#include "cloth/types.h"

namespace toile::skin {

/// Nearest points on a triangle surface (CGAL's AABB tree). Queries are const and may run from several threads.
class SurfaceQuery {
  public:
    SurfaceQuery(const Triangles& triangle, const Positions& position);
    ~SurfaceQuery();
    SurfaceQuery(SurfaceQuery&&) noexcept;

    struct Nearest {
        int triangle;
        Eigen::Vector3d barycentric;  ///< weights of the triangle's corners, in [0, 1], sum one
        Eigen::Vector3d position;
        double distance;         ///< unsigned [m]
        double signed_distance;  ///< negative inside, by the angle-weighted pseudonormal of the nearest feature [m]
    };
    Nearest nearest(const Eigen::Vector3d& point) const;

    /// Generalised winding number: near 1 inside a closed surface (2 where it overlaps itself), near 0 outside. Exact
    /// and linear in the number of triangles: for a few doubtful points.
    double winding_number(const Eigen::Vector3d& point) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::skin
