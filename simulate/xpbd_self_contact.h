#pragma once

#include <array>
#include <vector>

#include "simulate/self_contact.h"
#include "simulate/xpbd_constraints.h"

namespace toile::simulate {

/// The barrier of `SelfContact`, same pairs, same pressure, as unilateral constraints with friction: along the normal
/// of each pair where the step began, its energy is minimised exactly. What sweeps leave of a motion that would cross
/// is cut off by `limit`, as in `implicit`.
///
/// Holds what is near for the step under way, and lists of it that last for many steps. Only pairs that are within
/// `activation` of their thickness where the step begins are felt in it, so that forces depend on that position and not
/// on the lists. (So does `limit`, but for motions as long as the search's margin, a quarter of an edge.)
class XpbdSelfContact {
  public:
    XpbdSelfContact(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options,
                    double pressure);

    /// Finds what is near in `start` `[V x 3]` and the forces to begin with: none, or those of the energy, less
    /// where they are stiffer than a sweep can mend.
    void begin(const XpbdMobility& mobility, double time_step, bool keep_forces, const Positions& start);
    void add_forces(Positions& total) const;
    void sweep(const XpbdMobility& mobility, const Positions& start, Positions& x);
    /// Draws x back towards `start` until nothing crosses on the way.
    void limit(const Positions& start, Positions& x);

    /// Adds a bound on the stiffness that each vertex meets at x `[V]` [N/m].
    void add_stiffness(const Positions& x, Eigen::VectorXd& stiffness);
    /// The energy's forces at x, without friction, which holds nothing at rest.
    void add_static_forces(const Positions& x, Positions& total);

  private:
    struct Touch {
        std::array<int, 4> point;
        std::array<double, 4> weight;
        Eigen::Vector3d normal;
        SelfContact::Pair pair;
        double fade;
        double force = 0.0;                                  // along the normal [N]
        Eigen::Vector3d friction = Eigen::Vector3d::Zero();  // [N]
    };
    void look_around(const Positions& x);
    /// Pairs that are felt where the cloth is at x.
    void touch(const Positions& x);
    double solve(const Touch& touch, double free_distance, double yield, double guess) const;

    SelfContact contact_;
    int search_ = -1;                      // of contact_, that near_ is of
    std::vector<SelfContact::Pair> near_;  // with distances at found_at_, or less at the beginning of a step
    std::vector<size_t> index_;            // in contact_'s pairs
    std::vector<double> found_distance_;   // at found_at_
    Positions found_at_;
    Eigen::VectorXd moved_;  // from there
    std::vector<Touch> touches_;
    double smoothing_ = 0.0;  // of friction [m]
};

}  // namespace toile::simulate
