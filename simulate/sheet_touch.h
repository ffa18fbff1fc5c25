#pragma once

#include <array>
#include <vector>

#include "simulate/contact_candidates.h"
#include "simulate/feature_thickness.h"
#include "simulate/options.h"

namespace toile::simulate {

/// One vertex held off a weighted mean of three others: the form in which position-based solvers keep a vertex off a
/// triangle, and Bullet any soft contact. An edge off an edge takes the same form: their distance (1−s) a + s b −
/// (1−t) c − t d, divided by the weight of one end, is that end less a mean of the other three, with a negative weight.
struct SheetPush {
    int vertex;
    std::array<int, 3> other;
    std::array<double, 3> weight;  ///< of the others, 1 together
    Eigen::Vector3d normal;        ///< from the others' mean to the vertex
    double gap;                    ///< along the normal, to be kept in this substep [m]
    double vertex_share;           ///< of a correction, taken by the vertex ...
    double other_share;            ///< ... and by each other one, times its weight and the other way
    double grip;                   ///< share of the slip that friction takes
    bool recovering;               ///< from too near: the velocity that this gives is not to be kept
};

/// Touching of a cloth with itself, one substep after another, for solvers that move positions: vertices with
/// triangles, edges with edges. Each pair is kept on the side where it was when the substep began, at its thickness;
/// one that is nearer is taken apart at a bounded speed. Friction is Coulomb's, by what the substep would do without
/// contact. Corrections keep momentum where the four masses are equal, nearly so elsewhere.
///
/// What is found depends on the arguments alone, not on earlier calls.
class SheetTouches {
  public:
    /// `inverse_mass` `[V]` [1/kg], 0 for what is held.
    SheetTouches(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options,
                 Eigen::VectorXd inverse_mass);

    /// What the cloth does to itself on the way from `before` to `now` `[V x 3]` in a substep of `time_step` [s].
    /// `supported` `[V x 3]`: the normal of the solid that a vertex touches, or zero: what is pushed against its solid
    /// does not give way, if the other side can.
    const std::vector<SheetPush>& pushes(const Positions& before, const Positions& now, const Positions& supported,
                                         double time_step);

  private:
    struct Pair {
        std::array<int, 4> point;
        bool edges;
        double thickness;  // [m]
    };
    Proximity proximity(const Pair& pair, const Positions& x) const;
    void search(const Positions& x);
    void sieve(const Positions& x);
    void add_push(const Pair& pair, const Positions& before, const Positions& now, double time_step);
    double mobility(int vertex, const Eigen::Vector3d& way) const;
    SheetPush solved_for(int one, const Pair& pair, const Proximity& start, SheetPush push) const;
    bool add_shared(SheetPush push, bool supported);

    SelfContactOptions options_;
    Eigen::VectorXd inverse_mass_;
    FeatureThickness thickness_;
    ContactCandidates candidates_;
    double wide_;  // how far beyond the thickness is searched [m]
    CandidatePairs found_;
    std::vector<Pair> pairs_, near_;  // near each other at searched_at_; of these, nearer at sieved_at_
    Positions searched_at_, sieved_at_;
    Positions supported_;
    std::vector<SheetPush> pushes_;
};

}  // namespace toile::simulate
