#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "cloth/types.h"

namespace toile::evaluate {

/// The Dirichlet energy of a number per vertex, ½ Σ_e c_e (x_a − x_b)² = ½ xᵀ L x, with the cotangent weights of a mesh
/// of regular triangles: c_e = 1/(2√3) for each triangle at the edge. It is about ½ ∫ |∇x|² dA, which in two dimensions
/// depends neither on the size of the cloth nor on how finely it is meshed.
class MuSmoothing {
  public:
    MuSmoothing(const Triangles& triangle, int vertex_count);
    const Eigen::SparseMatrix<double>& laplacian() const { return laplacian_; }

  private:
    Eigen::SparseMatrix<double> laplacian_;  // L [V x V]
};

/// Variables z in which a smooth problem on the mesh is well conditioned, and which need no bounds.
///
/// With M = w L + (1/V) I = Rᵀ R: y = R⁻¹ z, and log μ = m + h tanh((y − m) / h), which stays within (m − h, m + h).
class MuVariables {
  public:
    MuVariables(const MuSmoothing& smoothing, double weight, double low, double high);

    Eigen::VectorXd log_mu(const Eigen::VectorXd& z) const;
    /// The z of a log μ `[V]`; one closer to a bound than a thousandth of their distance is moved away from it.
    Eigen::VectorXd of(const Eigen::VectorXd& log_mu) const;
    /// ∂/∂z of a function, of its derivative by log μ at z.
    Eigen::VectorXd pull_back(const Eigen::VectorXd& by_log_mu, const Eigen::VectorXd& z) const;

  private:
    Eigen::VectorXd unbounded(const Eigen::VectorXd& z) const;  // y

    double middle_, half_;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace toile::evaluate
