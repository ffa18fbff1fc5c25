#pragma once

#include <array>
#include <vector>

#include "cloth/lane_array.h"
#include "simulate/xpbd_batches.h"
#include "simulate/xpbd_mobility.h"

namespace toile::simulate {

/// Hinges that are flat at rest, energy ½ k |Σ w x|², as constraints of three numbers, Σ w x: the multiplier is k Σ w x
/// [N]. It moves along the curvature where the step began, so that forces have no torque about the positions they
/// started from. Eight hinges at a time.
class XpbdBending {
  public:
    /// Hinge (a, b, c, d) with the weights w [1/m] of the vertices and k [N m].
    void add(const std::array<int, 4>& vertex, const std::array<double, 4>& weight, double stiffness);
    /// Once all are added.
    void finish();
    int count() const { return static_cast<int>(vertex_.size()); }

    /// Turns forces `[H x 3]` along the curvature in `start` and adds those on the vertices to `total`.
    void begin(const Positions& start, Positions& force, Positions& total) const;
    void sweep(const XpbdMobility& mobility, const Positions& start, Positions& force, Positions& x) const;
    void follow(const XpbdMobility& mobility, const Positions& reached, Positions& kept) const;
    /// Row sums, without signs, of the energy's Hessian.
    void add_stiffness(Eigen::VectorXd& stiffness) const;

  private:
    std::vector<std::array<int, 4>> vertex_;
    std::vector<std::array<double, 4>> weight_;
    std::vector<double> stiffness_;
    std::vector<XpbdBatch<4>> batch_;
    LaneArray constants_;  // of each batch: four weights, stiffness
};

}  // namespace toile::simulate
