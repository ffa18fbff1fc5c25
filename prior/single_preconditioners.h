#pragma once

#include <memory>
#include <vector>

#include "cloth/lane_array.h"
#include "cloth/lane_cholesky.h"
#include "prior/preconditioner.h"
#include "prior/spring_graph.h"

namespace toile::prior {

/// Block Jacobi: the inverse of each vertex' own 3x3 block. What the paper's route uses.
class BlockJacobi final : public Preconditioner<1> {
  public:
    explicit BlockJacobi(const SpringGraph& graph);
    void factor(const double* form, const double* diagonal, const double* exact, double* lost_pivot) override;
    void solve(const double* r, double* z, double* r_dot_z) override;

  private:
    int vertex_count_;
    LaneArray inverse_;  // [V][9]
};

/// The whole Cholesky factor, with fill: for samples that are too stiff for the incomplete one.
class CompleteCholesky final : public Preconditioner<1> {
  public:
    explicit CompleteCholesky(const SpringGraph& graph);
    void factor(const double* form, const double* diagonal, const double* exact, double* lost_pivot) override;
    void solve(const double* r, double* z, double* r_dot_z) override;

  private:
    void assemble(const double* form, const double* diagonal, bool exact);

    const SpringGraph& graph_;
    std::vector<int> slot_;  // [S]
    std::unique_ptr<LaneCholesky<1>> cholesky_;
    LaneArray block_;
};

}  // namespace toile::prior
