#pragma once

#include <array>
#include <memory>

#include "cloth/lane_array.h"
#include "prior/linear_sweeps.h"
#include "prior/report.h"
#include "prior/spring_graph.h"

namespace toile::prior {

struct DerivativeRules {
    double reduction = 1e-5;       ///< of a residual in one round of conjugate gradients
    int max_sweeps = 300;          ///< in one round
    bool complete_factor = false;  ///< the preconditioner can tell whether a Hessian is positive definite
};

/// Solves H x = b with the exact Hessian at given positions, for W samples side by side: what both derivatives of the
/// quasistatic prior need. All numbers are in the graph's units and numbering; b may have any unit.
template <int W>
class DerivativeLanes {
  public:
    DerivativeLanes(const SpringGraph& graph, std::unique_ptr<LinearSweeps<W>> sweeps, const DerivativeRules& rules);

    /// Empties all lanes.
    void clear();
    /// Brings a sample's positions `[V x 3]` in; false if they are not finite, and the lane stays empty.
    bool load(int lane, const double* predicted, const double* position);
    /// Sets a lane's vector in `right_side` to `from` `[V x 3]`, false if that is not finite.
    bool set_right_side(int lane, const double* from);

    double* right_side() { return right_side_.data(); }            ///< `[V][3][W]`
    const double* position() const { return position_.data(); }    ///< `[V][3][W]` relative to each lane's mean
    const double* predicted() const { return predicted_.data(); }  ///< `[V][3][W]` relative to the same
    const double* solution() const { return solution_.data(); }    ///< `[V][3][W]`
    /// Empties one lane.
    void unload(int lane);
    bool loaded(int lane) const { return loaded_[lane]; }

    /// Builds the Hessians of all lanes. Once for any number of right-hand sides.
    void factor();
    /// Solves for all lanes and fills their reports, but for the time.
    void solve();
    const DerivativeReport& report(int lane) const { return report_[lane]; }

  private:
    void build();
    void normalize();
    void sweep();
    bool any_sweeping() const;
    void measure();
    void write_reports();

    const SpringGraph& graph_;
    std::unique_ptr<LinearSweeps<W>> sweeps_;
    DerivativeRules rules_;
    int size_;
    LaneArray predicted_, position_, right_side_, solution_, residual_, correction_, product_;
    alignas(64) double exact_[W], exact_factor_[W], lost_pivot_[W], length_[W], turn_[W], curvature_[W], squared_[W],
        largest_[W], sweep_largest_[W], r_dot_z_[W], r_dot_z_next_[W], size_of_right_side_[W];
    std::array<bool, W> loaded_{}, used_{}, sweeping_{}, given_up_{}, indefinite_{};
    std::array<DerivativeReport, W> report_;
};

extern template class DerivativeLanes<1>;
extern template class DerivativeLanes<8>;

}  // namespace toile::prior
