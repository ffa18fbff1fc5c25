#pragma once

#include <bitset>
#include <cstddef>
#include <memory>

#include "cloth/block_symbolic.h"

namespace toile {

/// Sparse Cholesky of W symmetric matrices of 3x3 blocks on one vertex graph, one in each SIMD lane: W = 8 for samples
/// that share a mesh, W = 1 for one alone. Owns numeric storage only; nothing is allocated after construction. One
/// object factors in one thread; many may share the symbolic part.
///
/// Arrays of W = 8 are aligned to 64 bytes (`LaneArray` in cloth/lane_array.h). A lane's results are bitwise the same
/// whatever is in the others.
///
///     auto symbolic = std::make_shared<const BlockSymbolic>(vertex_count, pairs);
///     LaneCholesky<8> cholesky(symbolic);
///     const std::bitset<8> good = cholesky.factor(blocks);   // blocks: [slot][9][8]
///     cholesky.solve(x);                                     // x: [V][3][8], right-hand sides in, solutions out
template <int W>
class LaneCholesky {
  public:
    explicit LaneCholesky(std::shared_ptr<const BlockSymbolic> symbolic);
    ~LaneCholesky();
    LaneCholesky(LaneCholesky&&) noexcept;
    LaneCholesky& operator=(LaneCholesky&&) noexcept;

    /// `blocks` is `[slot][9][W]`, each block row-major with rows of the larger vertex and columns of the smaller; of
    /// diagonal blocks the lower triangle is read. Tells which lanes are positive definite (a matrix with NaN or
    /// infinity is not). A lane that is not gives finite or non-finite nonsense in `solve` and disturbs no other.
    std::bitset<W> factor(const double* blocks);

    /// Solves A x = b with the last factor, in place; x is `[V][3][W]`. Two threads may solve at once.
    void solve(double* x) const;

    /// `factor`, then `solve`, with the same results to the last bit: half of the solving is done while the factor is
    /// still in the cache.
    std::bitset<W> factor_and_solve(const double* blocks, double* x);

    /// As `solve` for `count` right-hand sides of the one matrix; x is `[V][3][count]`, with no demand on alignment.
    void solve_many(double* x, int count) const requires(W == 1);

    const BlockSymbolic& symbolic() const { return *symbolic_; }
    /// Bytes of numeric storage.
    std::size_t storage_bytes() const;

  private:
    struct Storage;
    /// Factors and, where x is given, solves with L on the way.
    std::bitset<W> factor_forward(const double* blocks, double* x);
    void solve_backward(double* x) const;

    std::shared_ptr<const BlockSymbolic> symbolic_;
    std::unique_ptr<Storage> storage_;
};

extern template class LaneCholesky<1>;
extern template class LaneCholesky<8>;

}  // namespace toile
