#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace toile {

/// A symmetric matrix of 3x3 blocks on a fixed vertex graph: one entry for each pair of vertices that share a stencil.
/// Stored as the lower triangle in compressed columns of scalars `[3V x 3V]`, which is what CHOLMOD reads.
class BlockMatrix {
  public:
    /// `pairs` are vertex pairs in any order, repeated as they come; every vertex gets its diagonal block.
    BlockMatrix(int vertex_count, std::vector<std::pair<int, int>> pairs);

    int size() const { return 3 * vertex_count_; }
    const std::vector<int>& column_start() const { return column_start_; }  ///< `[3V + 1]`
    const std::vector<int>& row() const { return row_; }                    ///< `[nnz]`, rising in each column
    const std::vector<double>& value() const { return value_; }             ///< `[nnz]`

    void set_zero();
    /// Adds `block` at (i, j), and by symmetry its transpose at (j, i). Of a diagonal block the lower triangle is read.
    void add(int i, int j, const Eigen::Matrix3d& block);
    /// Adds `factor` times the identity at (i, j).
    void add_identity(int i, int j, double factor);
    /// Makes the rows and columns of `vertex` those of the identity: it is held in place.
    void fix(int vertex);
    double& diagonal(int scalar) { return value_[column_start_[scalar]]; }

    /// Position of block (i, j) with i >= j, to be kept by stencils: no search in the hot loop.
    int slot(int i, int j) const;
    /// As `add`, at a slot from `slot(i, j)` with i > j.
    void add_at(int slot, int j, const Eigen::Matrix3d& block);
    void add_identity_at(int slot, int j, double factor);

    /// y = A x, for `[3V]` vectors.
    void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  private:
    int vertex_count_;
    std::vector<int> neighbour_start_;  // by vertex, into neighbour_
    std::vector<int> neighbour_;        // larger neighbours of each vertex, rising
    std::vector<int> column_start_;
    std::vector<int> row_;
    std::vector<double> value_;
};

}  // namespace toile
