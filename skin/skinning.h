#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "skin/body.h"
#include "skin/pose.h"

namespace toile::skin {

enum class SkinningMethod { linear, dual_quaternion };

/// Posed body positions `[Vb x 3]`: linear blend skinning, or dual quaternions (Kavan et al. 2007) with the sign of
/// each quaternion taken towards the vertex' heaviest joint.
Positions skin_positions(const Body& body, const Pose& pose, SkinningMethod method);

/// The blended rotation at each body vertex: the normalised weighted sum of its joints' unit quaternions, signs aligned
/// to its heaviest joint. Smooth over the surface and over poses; a rigid motion of the whole body multiplies it from
/// the left.
std::vector<Eigen::Quaterniond> blended_rotations(const Body& body, const Pose& pose);

/// The joint that holds most of vertex v, the first of several.
int heaviest_joint(const SkinWeights& weight, int v);
/// Which joints are `top` or below it in the tree.
std::vector<bool> joints_below(const Body& body, int top);

}  // namespace toile::skin
