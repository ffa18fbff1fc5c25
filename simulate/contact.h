#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloth/block_values.h"
#include "cloth/cloth_mesh.h"
#include "cloth/topology.h"
#include "simulate/obstacle.h"
#include "simulate/options.h"

namespace toile::simulate {

/// A point of the cloth where contact is felt: a vertex (second < 0) or the middle of an edge.
struct ContactPoint {
    int first, second;
    int slot;     ///< of block (larger, smaller) in the Hessian, for edge points
    double area;  ///< pattern area it stands for [m^2]
};

/// Vertices and edge midpoints, so that a triangle's side cannot sink into a curved surface between two vertices that
/// rest on it. Half of the cloth's area goes to either kind.
std::vector<ContactPoint> contact_points(const ClothMesh& mesh, const Topology& topology,
                                         const BlockSymbolic& symbolic);

/// Contact and friction of one cloth with one obstacle.
///
/// Contact: a pressure p₀ (d/δ)² on each point that is nearer than the thickness δ, d = δ − φ(x), so p₀ where it
/// touches; energy A p₀ d³ / (3 δ²), twice differentiable at the onset. Friction: Coulomb with sticking. A point that
/// sticks is tied to an anchor that moves with the obstacle's piece by a spring, whose force ends at μ times the normal
/// force; once it slides, the anchor is dragged along (`end_step`). At rest it holds without creep. Normal force and
/// direction are lagged by one Newton iteration.
class Contact {
  public:
    Contact(const ContactOptions& options, double pressure, const std::vector<ContactPoint>& points,
            const Obstacle& obstacle);

    /// Ties the points to the pieces near them; anchors move with their pieces. Call when the obstacle has moved.
    void begin_step(const Positions& x);
    /// Looks up distances at x, which `add_gradient` and `add_hessian` then refer to, and takes friction's normal
    /// forces and directions from there.
    void linearise(const Positions& x);
    /// Anchors of sliding points follow.
    void end_step(const Positions& x);

    /// Friction's normal forces and directions stay those of the last `linearise`.
    double energy(const Positions& x) const;
    /// Friction's share of it.
    double friction_energy(const Positions& x) const;
    void add_gradient(Positions& gradient) const;
    /// Positive semidefinite: of the distance's own curvature it has where the solid is hollow, which holds the cloth
    /// more stiffly than a plane would, and not where it bulges.
    void add_hessian(BlockValues& hessian) const;

    /// The piece a vertex is tied to, and the one it starts from.
    int piece(int vertex) const { return state_[vertex].piece; }
    void set_piece(int vertex, int piece) { state_[vertex].piece = piece; }

    /// What a solver needs that keeps anchors and normal forces itself.
    const ContactOptions& options() const { return options_; }
    double pressure() const { return pressure_; }  ///< where cloth touches [Pa]
    /// Multiplies contact's pressure, and with it the stiffness of sticking.
    void stiffen(double factor);
    const std::vector<ContactPoint>& points() const { return points_; }
    const Obstacle& obstacle() const { return obstacle_; }
    /// The spring that ties a sticking point to its anchor under a normal force [N] when it has been `spring` [N/m]
    /// so far, 0 for a new anchor.
    double stick_spring(const ContactPoint& point, double normal_force, double spring) const;

  private:
    struct State {
        int piece = -1;
        Eigen::Vector3d position, gradient;  // at the last look-up
        Eigen::Matrix3d hollow;              // what the solid's hollows add to the Hessian [N/m]
        double distance = 0.0;
        double normal_force = 0.0;  // [N]
        bool anchored = false;
        double spring = 0.0;           // of sticking [N/m]
        Eigen::Vector3d anchor;        // in the piece's frame
        Eigen::Vector3d anchor_world;  // during this step
        Eigen::Vector3d normal;
    };
    Eigen::Vector3d position(const Positions& x, const ContactPoint& point) const;
    bool is_clear(const State& state, const Eigen::Vector3d& p) const;
    double pressure_at(double depth) const;
    Eigen::Vector3d slip_of(const State& state, const Eigen::Vector3d& p) const;
    double largest_friction(const State& state) const;
    double friction_energy(const State& state, const Eigen::Vector3d& p) const;
    Eigen::Matrix3d hessian_block(const ContactPoint& point, const State& state) const;
    void scatter(const ContactPoint& point, const Eigen::Vector3d& gradient, Positions& total) const;

    ContactOptions options_;
    double pressure_;
    double stick_stiffness_;  // per area [N/m^3]
    const std::vector<ContactPoint>& points_;
    const Obstacle& obstacle_;
    std::vector<State> state_;
};

}  // namespace toile::simulate
