#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "skin/pose.h"

namespace toile::evaluate {

/// Gathers which joints turn at all, over any number of poses.
class JointRange {
  public:
    void add(const skin::Pose& pose);
    /// Joints whose θ differs by more than 1e-9 rad between two of the poses, ascending.
    std::vector<int> varying() const;

  private:
    skin::Pose low_, high_;
};

/// Rotation matrices of `joint` less the identity, row by row: `[9 n]`. Unlike angles they are smooth everywhere.
Eigen::VectorXd rotation_features(const skin::Pose& pose, const std::vector<int>& joint);

/// Rotations of `joint` as unit quaternions.
std::vector<Eigen::Quaterniond> joint_rotations(const skin::Pose& pose, const std::vector<int>& joint);

/// Σ_j α_j², with α_j in [0, π] the angle of the rotation between joint j of the two poses [rad²]. Stops adding beyond
/// `bound`: the result is then above it, but not the sum. Exactly zero for equal quaternions.
double squared_pose_distance(const std::vector<Eigen::Quaterniond>& a, const std::vector<Eigen::Quaterniond>& b,
                             double bound);

}  // namespace toile::evaluate
