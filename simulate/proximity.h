#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace toile::simulate {

/// The four points of a contact [m]. Vertex–triangle: the vertex, then the triangle's corners. Edge–edge: the two ends
/// of the first edge, then those of the second.
using FourPoints = std::array<Eigen::Vector3d, 4>;

/// Where two features of a cloth are nearest to each other. The features are closed: a weight that is clamped is
/// exactly 0, so the nearest points then lie on a corner or a side.
///
/// The weights are signed, +1, −b₀, −b₁, −b₂ for vertex–triangle and 1−s, s, −(1−t), −t for edge–edge, so that for both
/// `difference` = Σ wᵢ xᵢ and, since the nearest points are a minimum, ∂(squared_distance)/∂xᵢ = 2 wᵢ `difference`.
struct Proximity {
    std::array<double, 4> weight;
    Eigen::Vector3d difference;  ///< from the second feature's nearest point to the first's [m]
    double squared_distance;     ///< [m^2]

    double distance() const { return std::sqrt(squared_distance); }  ///< [m]
};

/// Nearest points of a vertex x₀ and a triangle x₁x₂x₃. Triangles without area are the sides they collapse to.
/// The points are always inside the features, so rounding can make the distance too large but never too small.
Proximity vertex_triangle_proximity(const FourPoints& x);

/// Nearest points of the edges x₀x₁ and x₂x₃. Parallel edges have many; one is chosen at an end. Edges without length
/// are points.
Proximity edge_edge_proximity(const FourPoints& x);

/// How far the first feature lies in front of the second along a direction: min normal·x₀ − max normal·xⱼ and so on, in
/// the direction's units; negative where their shadows overlap. With a unit direction it never exceeds the distance,
/// and with that of `difference` it equals it. While the points move linearly it is concave in time: what it is at both
/// ends of a motion it is in between.
double vertex_triangle_separation(const Eigen::Vector3d& direction, const FourPoints& x);
double edge_edge_separation(const Eigen::Vector3d& direction, const FourPoints& x);

/// Where edges turn parallel the gradient of their distance jumps; energies of edge–edge contacts are multiplied by
/// this to stay smooth (Li et al. 2020, "Incremental potential contact", eq. 24): −c²/ε² + 2c/ε for
/// c = |(x₁−x₀)×(x₃−x₂)|² below ε, else 1. In [0, 1], continuously differentiable.
struct ParallelMollifier {
    double value;
    double slope;          ///< ∂value/∂c [1/m^4], 0 from ε on
    double squared_cross;  ///< c [m^4]
};
/// `threshold` is ε [m^4]; the paper takes `mollifier_threshold`.
ParallelMollifier parallel_mollifier(const FourPoints& x, double threshold);
/// ∂c/∂xᵢ [m^3]: times `slope` this is the mollifier's gradient.
FourPoints squared_cross_gradient(const FourPoints& x);
/// 10⁻³ times the product of the two squared rest lengths [m^4].
inline double mollifier_threshold(double rest_length, double other_rest_length) {
    return 1e-3 * rest_length * rest_length * other_rest_length * other_rest_length;
}

}  // namespace toile::simulate
