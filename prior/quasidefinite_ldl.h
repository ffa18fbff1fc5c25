#pragma once

#include <Eigen/SparseCore>
#include <memory>

namespace toile::prior {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// Sparse LDLᵀ (CHOLMOD, simplicial) of a symmetric matrix with a positive and a negative definite diagonal block, in
/// any order (quasi-definite): such a matrix has an LDLᵀ without pivoting for every ordering. Ordered by AMD and
/// analysed once for a pattern, factored many times. Reads the lower triangle, which must be compressed and sorted. One
/// object belongs to one thread.
class QuasidefiniteLdl {
  public:
    explicit QuasidefiniteLdl(const SparseMatrix& pattern);
    ~QuasidefiniteLdl();
    QuasidefiniteLdl(QuasidefiniteLdl&&) noexcept;
    QuasidefiniteLdl& operator=(QuasidefiniteLdl&&) noexcept;

    /// False if a value is not finite or a pivot vanished; the factor is then unusable. Throws Error if the pattern is
    /// not the one that was analysed.
    bool factor(const SparseMatrix& matrix);
    /// Solves with the last factor.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

    double factor_nonzeros() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::prior
