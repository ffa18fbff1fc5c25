#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <vector>

#include "cloth/block_symbolic.h"

namespace toile {

/// The values of one symmetric matrix of 3x3 blocks on the graph of a `BlockSymbolic`, as `LaneCholesky<1>` reads them:
/// `[slot][9]`, row-major, rows of the larger vertex and columns of the smaller.
class BlockValues {
  public:
    explicit BlockValues(std::shared_ptr<const BlockSymbolic> symbolic)
        : symbolic_(std::move(symbolic)), value_(9 * static_cast<std::size_t>(symbolic_->slot_count()), 0.0) {}

    const BlockSymbolic& symbolic() const { return *symbolic_; }
    const std::shared_ptr<const BlockSymbolic>& shared_symbolic() const { return symbolic_; }
    const double* data() const { return value_.data(); }
    double* block(int slot) { return value_.data() + 9 * static_cast<std::size_t>(slot); }

    void set_zero() { std::fill(value_.begin(), value_.end(), 0.0); }
    /// Adds a block with the larger vertex' rows; for a vertex' own slot a symmetric one.
    void add(int slot, const Eigen::Matrix3d& block_to_add) {
        double* value = block(slot);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) value[3 * r + c] += block_to_add(r, c);
    }
    void add_identity(int slot, double factor) {
        double* value = block(slot);
        for (int c = 0; c < 9; c += 4) value[c] += factor;
    }
    /// Makes the rows and columns of the vertices marked in `fixed` `[V]` those of the identity: they are held in
    /// place.
    void fix(const std::vector<bool>& fixed);
    /// y = A x, for `[3V]` vectors.
    void multiply(const double* x, double* y) const;

  private:
    std::shared_ptr<const BlockSymbolic> symbolic_;
    std::vector<double> value_;
};

}  // namespace toile
