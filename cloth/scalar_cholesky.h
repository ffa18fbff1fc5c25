#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "cloth/block_symbolic.h"

namespace toile {

/// Sparse Cholesky of one V x V matrix S for many right-hand sides: the matrix S ⊗ I_3 that all samples of a mesh have
/// in common. Factored in the constructor, const and shared by threads afterwards; `solve` allocates nothing.
class ScalarCholesky {
  public:
    /// `value` is `[slot]`: the diagonal, then one number for each pair, as `BlockSymbolic` numbers them. Throws Error
    /// if S is not positive definite or not finite.
    ScalarCholesky(std::shared_ptr<const BlockSymbolic> symbolic, const std::vector<double>& value);
    ~ScalarCholesky();
    ScalarCholesky(ScalarCholesky&&) noexcept;
    ScalarCholesky& operator=(ScalarCholesky&&) noexcept;

    /// Solves (S ⊗ I_3) x = b in place for W samples (1 or 8); x is `[V][3][W]`, for W = 8 aligned to 64 bytes. A
    /// lane's result is bitwise the same whatever is in the others.
    template <int W>
    void solve(double* x) const;

    const BlockSymbolic& symbolic() const { return *symbolic_; }
    /// Bytes of numeric storage.
    std::size_t storage_bytes() const;

  private:
    struct Storage;
    std::shared_ptr<const BlockSymbolic> symbolic_;
    std::unique_ptr<const Storage> storage_;
};

extern template void ScalarCholesky::solve<1>(double* x) const;
extern template void ScalarCholesky::solve<8>(double* x) const;

}  // namespace toile
