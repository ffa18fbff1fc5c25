#pragma once

#include <Eigen/Core>

#include "cloth/types.h"

namespace toile::evaluate {

/// Plain position-based projection (Müller et al., Position Based Dynamics, 2007, Sections 3.3 and 4.1), what people
/// use today to take the stretch out of cloth. An edge longer than its limit moves its two ends towards each other
/// until it has the limit, each by its share of the two inverse stiffnesses:
///
///     r_a −= w_a / (w_a + w_b) (l − l^max) n,   r_b += w_b / (w_a + w_b) (l − l^max) n,   w = 1 / k
///
/// An edge shorter than its limit is left alone. One sweep is one pass over all edges in their order (Gauss-Seidel).
/// Sweeps converge to positions within the limits, which are not the nearest such positions: no r* of the paper's
/// Section 3, and no gradient.
class PositionProjection {
  public:
    /// `edge` `[E x 2]`, `edge_max_length` `[E]` [m], `target_stiffness` `[V]` k_i, positive: as in
    /// prior::InextensibilityModel. Throws Error where the sizes do not fit.
    PositionProjection(const Edges& edge, const Eigen::VectorXd& edge_max_length,
                       const Eigen::VectorXd& target_stiffness);

    /// Sweeps over all edges; changes `position` `[V x 3]` [m]. Throws Error for another number of vertices.
    void sweep(Positions& position, int sweeps) const;
    /// max_e (l_e / l_e^max − 1) of positions `[V x 3]`, or 0 where no edge is longer than its limit.
    double overstretch(const Positions& position) const;

  private:
    Edges edge_;
    Eigen::VectorXd max_length_;
    Eigen::VectorXd first_share_;  // [E] of an edge's overlength that its first end takes
    Eigen::Index vertex_count_;
};

}  // namespace toile::evaluate
