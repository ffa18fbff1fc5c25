#pragma once

#include <array>
#include <memory>
#include <vector>

#include "cloth/block_values.h"
#include "cloth/lane_cholesky.h"

namespace toile::simulate {

/// A Hessian on the cloth's own graph, to which self-contact adds couplings that come and go, and its factorisation.
/// The cloth's graph is ordered once, for all drapes; a graph with couplings, made when one turns up that it lacks, is
/// eliminated in the same order, which costs little fill as long as they are few.
///
///     hessian.couple(touching, nearly_touching);   // zeroes the values
///     elasticity.add_hessian(x, hessian.own());
///     hessian.finish();                             // from here on values() holds everything
///     self_contact.add_hessian(hessian.values());
///     hessian.factor_and_solve(direction);
class CoupledHessian {
  public:
    explicit CoupledHessian(std::shared_ptr<const BlockSymbolic> own);

    /// Makes room for the blocks between the four vertices of each stencil in `needed`; where the graph must change,
    /// for those in `likely` too. Zeroes all values.
    void couple(const std::vector<std::array<int, 4>>& needed, const std::vector<std::array<int, 4>>& likely);
    /// What is on the cloth's own graph.
    BlockValues& own() { return own_; }
    /// Copies what is in `own` to the graph with couplings, if there are any.
    void finish();
    BlockValues& values() { return coupled_ ? *coupled_ : own_; }

    /// False where the matrix is not positive definite; x `[V x 3]` is then meaningless.
    bool factor_and_solve(double* x);
    /// With the last factor, in place.
    void solve(double* x) const;

  private:
    bool holds(const std::vector<std::array<int, 4>>& stencils) const;
    /// In the cloth's own order, or in one of its own.
    void rebuild(bool reorder);

    BlockValues own_;
    std::unique_ptr<LaneCholesky<1>> own_cholesky_;
    std::vector<std::pair<int, int>> coupling_;  // larger vertex first, each once, sorted
    std::unique_ptr<BlockValues> coupled_;
    std::unique_ptr<LaneCholesky<1>> coupled_cholesky_;
    std::vector<int> slot_;  // in the coupled graph, of each slot of the own
    int uses_ = 0;           // factorisations since the graph was ordered
    bool reordered_ = false;
};

}  // namespace toile::simulate
