#pragma once

#include <Eigen/Core>

namespace toile::prior {

/// A point (q0, q1) of R x R^3; it lies in the cone Q^4 of the paper's Section 4 if |q1| <= q0.
using ConePoint = Eigen::Vector4d;

/// q0² − |q1|², the product of the two eigenvalues q0 ± |q1|: positive inside the cone, zero on its boundary.
double cone_determinant(const ConePoint& q);

/// The conic product q ∘ p = (q·p, q0 p1 + p0 q1) (paper, Section 4).
ConePoint cone_product(const ConePoint& q, const ConePoint& p);

/// The x with q ∘ x = p, for q inside the cone.
ConePoint cone_divide(const ConePoint& q, const ConePoint& p);

/// The largest α in [0, limit] for which q + α dq stays in the cone, for q inside it.
double step_to_boundary(const ConePoint& q, const ConePoint& dq, double limit);

/// The Nesterov-Todd scaling of a pair (s, z) inside the cone: the symmetric W that maps cone to cone with
/// W z = W⁻¹ s. With w0² − |w1|² = 1 and J = diag(1, −1, −1, −1),
///
///     W = η [ w0  w1ᵀ ; w1  I + w1 w1ᵀ / (1 + w0) ],     W⁻² = (2 (J w)(J w)ᵀ − J) / η²
///
/// so the block of W⁻² that acts on q1 is (I + 2 w1 w1ᵀ) / η²: a multiple of the identity and one rank, for which the
/// linear system needs a single extra unknown.
struct ConeScaling {
    double eta = 1.0;
    double w0 = 1.0;
    Eigen::Vector3d w1 = Eigen::Vector3d::Zero();

    static ConeScaling of(const ConePoint& s, const ConePoint& z);
    ConePoint apply(const ConePoint& x) const;    ///< W x
    ConePoint unapply(const ConePoint& x) const;  ///< W⁻¹ x
};

}  // namespace toile::prior
