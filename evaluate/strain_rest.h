#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::evaluate {

/// What is wrong with a triangle or a vertex in one frame. Values that are not there are NaN, and never without one of
/// these.
enum class StrainFault : std::int8_t {
    none = 0,
    degenerate_rest,  ///< the rest triangle has no area: no values
    collapsed,        ///< the deformed one has none: stretches hold, rotation and directions are not unique, no rates
    inverted,         ///< turned over: in a flat mesh against the other triangles, at a vertex det F < 0; values hold
    too_few,          ///< the neighbourhood has fewer than three vertices: no values
    low_rank,         ///< the neighbourhood spans no plane (without the normal: no space): no values
    no_normal,        ///< no triangle with an area at the vertex, at rest or deformed: no values
    overflow,         ///< numbers too large or too small for double precision: no values
};
inline constexpr int strain_fault_count = 8;
const char* strain_fault_name(StrainFault fault);  ///< "degenerate rest", "collapsed" ...
inline bool has_strain(StrainFault fault) {
    return fault == StrainFault::none || fault == StrainFault::collapsed || fault == StrainFault::inverted;
}

/// The surface that strain is measured from: the pattern where there is one, as points (u, v, 0), else the rest
/// positions. A seam vertex has a point in each of its panels.
struct StrainRest {
    struct Triangle {
        Eigen::Matrix<double, 3, 2> axis;  ///< an orthonormal frame in its plane; of a pattern u and v
        Eigen::Matrix2d inverse_edge;      ///< of the edges from the first corner to the two others, in that frame
        StrainFault fault = StrainFault::none;
    };

    bool from_pattern = false;
    int vertex_count = 0;
    Triangles mesh_triangle;          ///< `[F x 3]` vertices
    Triangles triangle;               ///< `[F x 3]` points
    Positions point;                  ///< `[P x 3]` [m]
    std::vector<int> vertex;          ///< `[P]` the vertex of each point, -1 of a pattern position without a triangle
    Positions normal;                 ///< `[P x 3]` unit, angle-weighted within the panel; zero where there is none
    std::vector<Triangle> frame;      ///< `[F]`
    std::vector<double> orientation;  ///< `[F]` of a flat surface +1 or -1 against the sum of all areas; else empty
};

/// Throws Error for a mesh without triangles, with indices out of range or positions that are not finite; `where` is
/// its file. Whatever else may be wrong with it is a fault of its triangles and vertices.
StrainRest strain_rest(const ClothMesh& mesh, const std::string& where);

/// Positions of the points in space: those of their vertices, zero for a point without one.
Positions point_positions(const StrainRest& rest, const Positions& position);

/// No area beyond rounding: the smallest height is below 1e-10 of the longest edge, or what coordinates of this size
/// resolve.
bool is_degenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// Of a surface in a plane, for each triangle with an area, whether its normal goes with the sum of all area vectors
/// (+1) or against it (-1), else 0; empty where the surface is not flat or that sum vanishes.
std::vector<double> flat_orientation(const Triangles& triangle, const Positions& position);

}  // namespace toile::evaluate
