#pragma once

#include <Eigen/Core>

#include "cloth/types.h"

namespace toile::simulate {

/// How a step of length h with damping α turns a force on a vertex into a move: q times its inverse mass.
struct XpbdMobility {
    double squared_time;                  ///< q = h² / (1 + α h) [s^2]
    const Eigen::VectorXd& inverse_mass;  ///< `[V]` [1/kg], 0 where pinned
};

/// A block up to this stiff, as q D G, keeps its force in full, a stiffer one less: sweeps approach the forces of stiff
/// blocks slowly, and kept in full the rest would build up and overshoot, step after step (integral windup).
constexpr double largest_kept_stiffness = 4.0;

inline double kept_share(double stiffness) {
    return stiffness > largest_kept_stiffness ? largest_kept_stiffness / stiffness : 1.0;
}

}  // namespace toile::simulate
