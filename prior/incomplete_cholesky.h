#pragma once

#include <vector>

#include "cloth/lane_array.h"
#include "prior/float_lanes.h"
#include "prior/preconditioner.h"
#include "prior/spring_graph.h"

namespace toile::prior {

/// Incomplete Cholesky factor, without fill, of W Hessians on a spring graph (cloth/lane.h), in blocks of 3x3: the
/// preconditioner of the quasistatic prior. (L + D) D⁻¹ (L + D)ᵀ with L below the diagonal; the solve is bound by
/// memory: L is kept with eight bits of precision, and the rest is done in single. Positive definite always: where a
/// pivot is lost, the matrix' own diagonal block takes its place.
template <int W>
class IncompleteCholesky final : public Preconditioner<W> {
  public:
    explicit IncompleteCholesky(const SpringGraph& graph);

    void factor(const double* form, const double* diagonal, const double* exact, double* lost_pivot) override;
    /// z = (L + D)⁻ᵀ D (L + D)⁻¹ r.
    void solve(const double* r, double* z, double* r_dot_z) override;

    /// The same for forms and vectors in single precision.
    void factor_single(const SingleLanes<W>* form, const double* diagonal, const double* exact, double* lost_pivot);
    void solve_single(const SingleLanes<W>* r, SingleLanes<W>* z, double* r_dot_z);

    /// L's blocks, `[S][packed]` (prior/float_lanes.h), and D⁻¹, `[V][6]` (xx, yx, yy, zx, zy, zz).
    const SingleLanes<W>* lower() const { return lower_.data(); }
    const SingleLanes<W>* pivot() const { return pivot_.data(); }

  private:
    const SpringGraph& graph_;
    std::vector<SingleLanes<W>> lower_;  // [S][packed], rows of L
    LaneArray inverse_;                  // [V][6][W], D⁻¹
    std::vector<SingleLanes<W>> pivot_;  // [V][6], D⁻¹ again
    LaneArray row_;                      // [widest row][9][W], L D⁻¹ of the row at work
    std::vector<SingleLanes<W>> w_, u_;  // [V][3]
};

extern template class IncompleteCholesky<1>;
extern template class IncompleteCholesky<8>;

}  // namespace toile::prior
