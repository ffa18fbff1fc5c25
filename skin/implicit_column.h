#pragma once

#include <Eigen/Core>
#include <vector>

namespace toile::skin {

/// A cross-section of a column: two half ellipses that share a width, one in front and one behind.
struct Section {
    double at;                 ///< distance along the axis [m]
    double side;               ///< half width [m]
    double front;              ///< half depth in front of the centre [m]
    double back;               ///< half depth behind the centre [m]
    double shift_side = 0.0;   ///< centre of the section off the axis, to the side [m]
    double shift_front = 0.0;  ///< the same, to the front [m]
};

/// Where a column stands: a right-handed frame (side, front, along).
struct ColumnFrame {
    Eigen::Vector3d origin;
    Eigen::Vector3d along;  ///< direction of the axis
    Eigen::Vector3d front;  ///< roughly; made perpendicular to the axis
};

/// How far the rounded ends reach beyond the first and the last section [m].
struct ColumnCaps {
    double start, end;
};

/// A limb as an implicit shape: sections along a straight axis, joined by monotone cubics (Fritsch and Carlson 1980)
/// and closed by half ellipsoids at both ends.
class ImplicitColumn {
  public:
    /// `sections` ascending in `at`, at least two; `squareness` is their exponent: 2 an ellipse, more is boxier.
    ImplicitColumn(const ColumnFrame& frame, std::vector<Section> sections, const ColumnCaps& caps,
                   double squareness = 2.0);

    /// Negative inside; a distance to first order near the surface [m].
    double distance(const Eigen::Vector3d& point) const;

    /// A lower bound of the distance to the column that is quick to find [m].
    double distance_bound(const Eigen::Vector3d& point) const;

    /// The mirror image in the plane x = 0.
    ImplicitColumn mirrored() const;

  private:
    Section section_at(double along) const;

    struct Local {
        double side, front, along;
    };
    Local to_local(const Eigen::Vector3d& point) const;

    Eigen::Vector3d side_, front_, along_;  // unit vectors
    Eigen::Vector3d origin_;
    std::vector<Section> section_;
    std::vector<Section> slope_;  // at the sections
    ColumnCaps cap_;
    double squareness_;
    double reach_;  // farthest a section or a cap goes from the axis between the sections
};

/// Union with the seam rounded over a width of about `blend` [m] (polynomial smooth minimum, Quilez 2013).
double smooth_union(double a, double b, double blend);

}  // namespace toile::skin
