#pragma once

#include <vector>

#include "simulate/contact_candidates.h"

namespace toile::simulate {

/// The room between sheets of a mesh that does not cross itself.
class SheetGap {
  public:
    /// All must outlive the object. Vertices that are not `free` do not move.
    SheetGap(const Triangles& triangle, const Edges& edge, const std::vector<bool>& free);

    /// Distance of the nearest two features (vertex and triangle, or two edges) that share no vertex, one of them with
    /// a `marked` vertex; `radius` [m] where none is nearer.
    double smallest(const std::vector<bool>& marked, double radius, const Positions& x);
    /// Pushes such features that are nearer than `gap` apart, by `share` of what they lack. Nothing keeps them from
    /// meeting others on the way.
    void open(const std::vector<bool>& marked, double gap, double share, Positions& x);

  private:
    template <class Visit>
    void each_near(const std::vector<bool>& marked, double radius, const Positions& x, Visit&& visit);

    const std::vector<bool>& free_;
    ContactCandidates candidates_;
    CandidatePairs pairs_;
};

}  // namespace toile::simulate
