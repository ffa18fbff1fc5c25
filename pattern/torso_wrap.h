#pragma once

#include <Eigen/Core>
#include <vector>

#include "pattern/body_measure.h"
#include "skin/body.h"

namespace toile::pattern {

/// A smooth skin around the trunk, outside the body, on which the panels of a shirt are laid: below the underarm line
/// loops around the vertical axis; above it a yoke of sagittal columns that run from the line at the front over the
/// shoulder to the line at the back.
class TorsoWrap {
  public:
    struct Options {
        double underarm_height;  ///< [m]
        double lowest_height;    ///< [m]
        double neck_half_width;  ///< the yoke's innermost columns, from the axis [m]
        double tip_half_width;   ///< the yoke's outermost columns, from the axis [m]
        double clearance;        ///< least distance from the body's convex sections [m]
    };
    TorsoWrap(const skin::Body& body, const BodyMeasure& measure, const Options& options);

    /// Circumference of the trunk's section itself at `height` [m].
    double tape(double height) const;
    /// The point of the loop of this `circumference` [m] (more where the body and its clearance need it) at `height`, a
    /// `share` in [0, 1) of the way round from the front's middle over the wearer's left.
    Eigen::Vector3d loop_point(double height, double share, double circumference) const;

    enum Half { front = 0, back = 1 };
    /// Length of a column from the underarm line to the shoulder ridge [m]; `x` from the axis, to the wearer's left
    /// [m].
    double column_length(Half half, double x) const;
    /// The point a `share` of the way up a column.
    Eigen::Vector3d yoke_point(Half half, double x, double share) const;

  private:
    struct Column {
        double x;
        std::vector<Eigen::Vector2d> rise[2];  // (z, y), evenly spaced by arc length
        double length[2];
    };
    Column make_column(const skin::Body& body, const BodyMeasure& measure, double x) const;
    void trace(const TapeLoop& profile, double ridge_z, Column& column) const;

    Options options_;
    double center_x_, center_z_;
    double level_step_ = 0.012;
    std::vector<std::vector<Eigen::Vector2d>> level_;  // hulls of sections, from the lowest height upwards
    std::vector<double> tape_;
    std::vector<Column> column_;  // by increasing x
};

}  // namespace toile::pattern
