#pragma once

#include <optional>
#include <vector>

#include "simulate/contact.h"

namespace toile::simulate {

/// A vertex in one substep of a solver that knows positions alone.
struct MovingVertex {
    Eigen::Vector3d before, now;  ///< where the substep began, and where it leads without contact [m]
    double mass, time_step;       ///< [kg], [s]
};

/// What a solid does to a vertex in one substep.
struct SolidPush {
    Eigen::Vector3d normal;
    double move;            ///< along the normal, from `MovingVertex::now` [m]
    Eigen::Vector3d along;  ///< tangential velocity of the surface, relative to the carried frame [m/s]
    double grip;            ///< share of the slip against the surface that friction takes
    bool recovering;        ///< from below the thickness: the velocity that this gives is not to be kept
};

/// Touching of all vertices with one solid, one substep after another, for solvers that move positions instead of
/// balancing forces: the thickness is kept exactly, friction is Coulomb's with the normal impulse of the substep
/// before.
///
/// A vertex below the thickness is taken back at a bounded speed. One squeezed between two surfaces finds its normal
/// turned round each time one has pushed it to the other: the pushes are halved each time until it rests between them.
/// A vertex that touches sees the solid as the plane of its last look-up until it has moved by a tenth of the thickness
/// or is as far below it. State of one drape; const members of `Contact` alone are used.
class SolidTouches {
  public:
    SolidTouches(const Contact& contact, int vertex_count);

    /// The solid has moved, or vertices are tied to other pieces of it: look all distances up again.
    void forget_distances();
    /// Remembers where on its piece each vertex of x `[V x 3]` is.
    void tie(const Positions& x);
    /// The solid has just moved and would take the cloth to `carried` `[V x 3]` in `time` [s]: how its surface moves
    /// beyond that.
    void take_surface_velocities(const Positions& carried, double time);
    void rest_surface();

    /// What happens to a vertex in this substep; nothing where it is clear of the solid.
    std::optional<SolidPush> push(int vertex, const MovingVertex& moving);
    /// The impulses that came of it [N s].
    void weigh(int vertex, double normal_impulse, double tangential_impulse);

    /// Of a vertex, in the last substep.
    struct Touch {
        bool known = false;                   // whether the solid was looked up ...
        Eigen::Vector3d looked_up, gradient;  // ... here, with this result
        double distance = 0.0;                // [m]
        Eigen::Vector3d local;                // in its piece's frame, before the solid moves
        Eigen::Vector3d surface_velocity = Eigen::Vector3d::Zero();
        bool touched = false;  // with these [N s]
        double normal_impulse = 0.0, tangential_impulse = 0.0;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double ease = 1.0;  // of the recovery speed
        double grip = 0.0;
    };
    /// All that a trial changes.
    using State = std::vector<Touch>;
    const State& state() const { return touch_; }
    void set_state(const State& state) { touch_ = state; }

  private:
    std::optional<Obstacle::Contact> look(int vertex, const Eigen::Vector3d& x);
    std::optional<SolidPush> push_from(const Obstacle::Contact& found, const MovingVertex& moving, Touch& touch) const;

    const Contact* contact_;
    State touch_;
};

}  // namespace toile::simulate
