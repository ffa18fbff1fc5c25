#pragma once

#include <limits>

#include "cloth/types.h"
#include "simulate/contact_candidates.h"
#include "simulate/proximity.h"

namespace toile::simulate {

struct SafeMotionOptions {
    /// Share of a pair's starting distance beyond `separation` that stays, in (0, 1).
    double remaining_share = 0.1;
    /// As much beyond `separation` is always enough [m]: else two that start far apart would be kept far apart.
    double largest_remaining = std::numeric_limits<double>::infinity();
    /// Distance that is never undercut [m]. A pair that starts nearer keeps `remaining_share` of its distance instead.
    double separation = 0.0;
    /// Bound on the steps of a pair; where it ends, the motion found safe so far is the answer.
    int steps = 200;
};

/// The share in [0, limit] of the motion x to x + motion that a vertex and a triangle, or two edges, can go without
/// coming nearer than the options allow. Conservative whatever the shape: each step is proven by a plane that keeps
/// both features on its sides. 0 where they touch at the start and move relative to each other.
///
/// Additive conservative advancement (Li, Kaufman, Jiang 2021, "Codimensional incremental potential contact",
/// algorithm 1) with a longer step: there, the distance d is eaten up by the largest relative speed in any direction,
/// here by the approach along the line of the nearest points, which is linear in time for each pair of vertices. So
/// sliding past each other costs no steps. Each step is at least as long as theirs.
double vertex_triangle_safe_share(const FourPoints& x, const FourPoints& motion, const SafeMotionOptions& options = {},
                                  double limit = 1.0);
double edge_edge_safe_share(const FourPoints& x, const FourPoints& motion, const SafeMotionOptions& options = {},
                            double limit = 1.0);

/// The least over all pairs, which must hold those that `ContactCandidates::find` finds for this motion and
/// `separation`.
double safe_share(const CandidatePairs& pairs, const Positions& x, const Positions& motion,
                  const SafeMotionOptions& options = {}, double limit = 1.0);

}  // namespace toile::simulate
