#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "evaluate/neighbourhood.h"
#include "evaluate/strain_rest.h"

namespace toile::evaluate {

/// How the neighbourhood of a vertex is deformed.
struct VertexStrain {
    StrainFault fault = StrainFault::none;
    Eigen::Matrix3d gradient;         ///< F
    Eigen::Quaterniond rotation;      ///< Kabsch's: the proper rotation nearest to the neighbourhood's motion
    Eigen::Vector3d stretch;          ///< l1 >= l2 >= l3 of F
    Eigen::Matrix3d rest_direction;   ///< columns: unit, at rest
    Eigen::Matrix3d direction;        ///< columns: unit, in space
    Eigen::Vector2d surface_stretch;  ///< the two of F within the rest tangent plane
    double residual = 0;              ///< root mean square of F p - q over that of q: what one F cannot explain
};

/// Fits F to each vertex' neighbourhood by least squares. With p and q the points at rest and deformed, each from its
/// neighbourhood's centroid, N and n the unit normals there, s the root mean square of |p|, and m the number of points,
///
///     F = argmin  sum_j |F p_j - q_j|^2 + w m s^2 |F N - n|^2 .
///
/// The normal makes a flat neighbourhood well posed: F is then its deformation in the plane, and N goes to n. Where a
/// neighbourhood is curved, w decides between its points and the sheet's thickness, which is taken to stay as it is; w
/// = 0 leaves the normal out, and then flat neighbourhoods are of low rank. Kabsch's rotation is that of the same
/// correspondences: with H = sum q p^T + w m s^2 n N^T = A S B^T, R = A diag(1, 1, det(A B^T)) B^T.
///
/// What depends on the rest state alone is worked out once; a frame is then a product for each vertex.
class VertexStrainFit {
  public:
    /// `normal_weight` is w >= 0.
    VertexStrainFit(const StrainRest& rest, const Neighbourhoods& neighbourhoods, double normal_weight, int jobs);

    /// Of all vertices `[V]`; `position` `[V x 3]`, finite.
    std::vector<VertexStrain> fit(const Positions& position, int jobs) const;

  private:
    struct Vertex {
        StrainFault fault = StrainFault::none;
        Eigen::RowVector3d normal_weights;  ///< of n in F
        double scale = 0;                   ///< w m s^2
    };
    Eigen::Matrix3d fit_gradient(int v, const Positions& point, const Eigen::Vector3d& normal,
                                 VertexStrain& strain) const;
    VertexStrain fit_vertex(int v, const Positions& point, const Positions& normal) const;
    void prepare(int v);

    const StrainRest& rest_;
    const Neighbourhoods& around_;
    double normal_weight_;
    std::vector<Vertex> vertex_;  ///< `[V]`
    Positions weights_;           ///< `[points of all neighbourhoods x 3]` F = sum_j q_j weights_j + n normal_weights
};

}  // namespace toile::evaluate
