#pragma once

#include <Eigen/Core>
#include <functional>

#include "skin/surface_extraction.h"

namespace toile::skin {

/// Evens out the triangles of an extracted surface: vertices move within the surface towards the mean of their
/// neighbours and back onto the zero of `distance`, and edges flip to the Delaunay side, `rounds` times. Keeps the
/// number of vertices and triangles and the topology of the surface.
void relax_surface(const std::function<double(const Eigen::Vector3d&)>& distance, int rounds, Surface& surface);

}  // namespace toile::skin
