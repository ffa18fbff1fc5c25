#pragma once

#include <array>
#include <vector>

#include "cloth/block_values.h"
#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"
#include "simulate/contact_candidates.h"
#include "simulate/continuous_collision.h"
#include "simulate/feature_thickness.h"
#include "simulate/options.h"

namespace toile::simulate {

/// Contact and friction of one cloth with itself: vertices with triangles, edges with edges.
///
/// Contact is a barrier that starts as with a solid (`Contact`): a pressure p₀ (δ − d)² / (δ d) where two features are
/// at a distance d less than the thickness δ, p₀ being a solid's where the cloth touches it. The normal is that of the
/// nearest points, lagged by one Newton iteration in the Hessian only. δ is less between features that are smaller than
/// twice δ, so that a fine mesh at rest does not touch itself. Edges that turn parallel fade out (Li et al. 2020, eq.
/// 24). Friction is Coulomb's, lagged, against the motion since `begin_step`, and smoothed below the speed
/// `sticking_speed`: it slows cloth that slides on itself and holds nothing at rest.
///
/// Nothing ever crosses: `limit` shortens each motion of the cloth, where it is needed and only there, until continuous
/// collision detection finds it safe.
class SelfContact {
  public:
    struct Pair {
        std::array<int, 4> point;
        bool edges;        // edge–edge, else vertex–triangle
        double area;       // [m^2]
        double thickness;  // [m]
        double distance;   // at the last linearise, or less [m]
    };
    struct Pressure {
        double energy, force, slope;  // [J], [N], [N/m]
    };

    SelfContact(const ClothMesh& mesh, const Topology& topology, const SelfContactOptions& options, double pressure);

    /// Friction is against motion from x, smoothed for a step of `time_step` [s].
    void begin_step(const Positions& x, double time_step);
    /// Finds what is near x, if that is not known already. Call it before `linearise`.
    void look_around(const Positions& x);
    /// Shortens the motion of each vertex until nothing crosses on the way from x, and looks along what is left.
    /// Returns the smallest share that is left. `linearise` is done again, at x, where pairs had to be looked for.
    double limit(const Positions& x, Positions& motion);
    /// As `limit`, but shortens all vertices' motions by one share.
    double limit_alike(const Positions& x, Positions& motion);
    /// Whether the whole motion crosses nothing, as far as that can be told without a search.
    bool is_known_safe(const Positions& x, const Positions& motion) const;

    /// Takes distances, normals and forces at x, which `add_gradient` and `add_hessian` then refer to.
    void linearise(const Positions& x);
    double energy(const Positions& x) const;
    void add_gradient(Positions& gradient) const;
    /// The four vertices of each pair that touches: the blocks that `add_hessian` needs.
    const std::vector<std::array<int, 4>>& touching() const { return touching_; }
    /// Those of pairs that may touch soon: within twice the thickness.
    const std::vector<std::array<int, 4>>& nearly_touching() const { return nearly_touching_; }
    /// Positive semidefinite.
    void add_hessian(BlockValues& hessian) const;

    /// What a solver needs that keeps forces itself: all pairs within reach of the last search, in the search's order.
    const std::vector<Pair>& pairs() const { return pairs_; }
    /// How many searches there were: `pairs` changes with each.
    int searches() const { return searches_; }
    const SelfContactOptions& options() const { return options_; }
    Proximity proximity(const Pair& pair, const Positions& x) const;
    /// What pair `index` of `pairs` is faded to, 1 but for edges that turn parallel.
    double fade(size_t index, const Positions& x) const;
    /// Without the fade.
    Pressure pressure_at(const Pair& pair, double distance) const;
    /// As `limit`, among these pairs alone.
    double limit_among(const std::vector<Pair>& pairs, const Positions& x, Positions& motion) const;

  private:
    struct Touch {
        std::array<int, 4> point;
        std::array<double, 4> weight;
        Eigen::Vector3d normal;
        double force, slope;      // of the pressure [N], [N/m]
        Eigen::Vector3d slip;     // since begin_step, in the tangent plane
        double largest_friction;  // [N]
        int pair;
        double fade;  // of edges that turn parallel
    };
    bool covers(const Positions& x, double reach) const;
    /// Returns the share of the motion that it looked along.
    double search(const Positions& x, const Positions& motion);
    void collect(const Positions& x);
    double safe_share(const std::vector<Pair>& pairs, const Positions& x, const Positions& motion) const;
    /// `length` `[V]` of each vertex' motion; the pair's distance is that at x.
    double pair_safe_share(const Pair& pair, const Positions& x, const Positions& motion,
                           const Eigen::VectorXd& length) const;
    double friction_energy(const Touch& touch, const Positions& x) const;

    SelfContactOptions options_;
    double pressure_;
    Eigen::VectorXd vertex_area_, edge_area_;  // [m^2]
    Eigen::VectorXd rest_length_;
    FeatureThickness thickness_;
    ContactCandidates candidates_;
    CandidatePairs found_;
    std::vector<Pair> pairs_;
    Positions found_at_;     // where pairs_ were looked for ...
    Positions found_along_;  // ... and along what motion from there; empty for none
    double margin_ = 0.001;  // around both [m]
    int searches_ = 0;
    Positions before_;
    double smoothing_ = 0.0;  // of friction [m]
    std::vector<Touch> touches_;
    std::vector<double> fade_;  // by pair
    Positions linearised_at_;
    std::vector<std::array<int, 4>> touching_, nearly_touching_;
};

}  // namespace toile::simulate
