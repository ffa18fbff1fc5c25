#pragma once

#include <Eigen/Core>
#include <functional>

#include "cloth/types.h"

namespace toile::skin {

struct Surface {
    Triangles triangle;
    Positions position;
};

/// The zero surface of `distance` (negative inside; outside at most about twice a distance) within the box, as
/// triangles counter-clockwise outside, by dual contouring. `voxel` [m] sets the resolution. Throws Error where the
/// surface leaves the box or the distance is not finite.
Surface extract_surface(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& lower,
                        const Eigen::Vector3d& upper, double voxel);

}  // namespace toile::skin
