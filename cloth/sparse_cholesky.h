#pragma once

#include <Eigen/Core>
#include <memory>

#include "cloth/block_matrix.h"

namespace toile {

/// Sparse Cholesky of a `BlockMatrix` (CHOLMOD): ordered and analysed once for a graph, factored many times. Reads the
/// lower triangle. One object belongs to one thread; copies of the analysis are cheap to make by constructing again.
class SparseCholesky {
  public:
    explicit SparseCholesky(const BlockMatrix& pattern);
    ~SparseCholesky();
    SparseCholesky(SparseCholesky&&) noexcept;

    /// False if the matrix is not positive definite; the factor is then unusable. Throws Error if the pattern is not
    /// the one that was analysed or a value is not finite.
    bool factor(const BlockMatrix& matrix);
    /// Solves A x = b with the last factor.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

    double factor_nonzeros() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile
