#pragma once

#include <cstdint>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::evaluate {

// Cloth made by code for the stability suite: flat at rest, pattern = shape, masses for the density given [kg/m^2].

/// Evenly spaced positions from 0 to `length` [m], `cells` apart.
std::vector<double> even_lines(int cells, double length);

/// A rectangle in the plane y = `height`, centred on the y axis, with a grid line at each u and v [m]; diagonals
/// alternate. Outside is up; v runs towards -z. Vertex of (i, j): j * u.size() + i.
ClothMesh grid_cloth(const std::vector<double>& u, const std::vector<double>& v, double height,
                     double density_per_area);

/// A disc of `sectors` triangles around, in rings whose widths grow with the radius, so that triangles keep their
/// shape: edges grow from the inner to the outer radius [m] by the ratio of the two. Otherwise as `grid_cloth`.
ClothMesh graded_disc(int sectors, double inner_radius, double outer_radius, double height, double density_per_area);

/// Every coordinate moved by up to `size` [m], from a seeded draw.
void shake(Positions& x, double size, std::uint64_t seed);

}  // namespace toile::evaluate
