#pragma once

#include <string>

#include "cloth/types.h"

namespace toile {

/// A garment's mesh: sewn in space, flat in the pattern. The pattern is the rest state.
///
/// A seam vertex has one pattern position for each panel that meets there, so P >= V. Row f of `pattern_triangle` holds
/// the pattern indices of the corners of row f of `triangle`, in the same order.
struct ClothMesh {
    Triangles triangle;               ///< `[F x 3]` into `rest_position`
    Positions rest_position;          ///< `[V x 3]` neutral-pose positions [m]
    PlanePositions pattern_position;  ///< `[P x 2]` [m]
    Triangles pattern_triangle;       ///< `[F x 3]` into `pattern_position`
    Eigen::VectorXd mass;             ///< `[V]` lumped vertex mass [kg]

    int vertex_count() const { return static_cast<int>(rest_position.rows()); }
    int triangle_count() const { return static_cast<int>(triangle.rows()); }
};

/// Lumped vertex masses `[V]` [kg]: a third of each adjacent triangle's pattern area times `density_per_area` [kg/m^2].
Eigen::VectorXd lumped_mass(const ClothMesh& mesh, double density_per_area);

/// Refuses what no solver can use; throws `Error` naming the first offending vertex, edge or triangle. `where` is the
/// file the mesh came from. Checks: at least one triangle, indices in range, finite positions, no isolated vertex, no
/// triangle with a repeated vertex, zero pattern area or zero rest area, no edge with more than two triangles,
/// consistent winding.
void check_cloth_mesh(const ClothMesh& mesh, const std::string& where);

}  // namespace toile
