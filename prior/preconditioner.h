#pragma once

namespace toile::prior {

/// What stands for the inverse Hessian in conjugate gradients, of W samples side by side (cloth/lane.h).
template <int W>
class Preconditioner {
  public:
    virtual ~Preconditioner() = default;

    /// Takes the Hessians that `form` and `diagonal` hold (prior/spring_lanes.h), projected where `exact` `[W]` is 0.
    /// Lanes that were not positive definite have `lost_pivot` `[W]` above 0, and something positive definite in their
    /// place.
    virtual void factor(const double* form, const double* diagonal, const double* exact, double* lost_pivot) = 0;

    /// z of r, `[V][3][W]`, and the sum r·z `[W]`.
    virtual void solve(const double* r, double* z, double* r_dot_z) = 0;
};

}  // namespace toile::prior
