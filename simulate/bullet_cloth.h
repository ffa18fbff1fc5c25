#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "simulate/drape.h"
#include "simulate/sheet_touch.h"
#include "simulate/solid_touch.h"
#include "simulate/spring_network.h"

namespace toile::simulate {

/// What a `BulletCloth` is made of.
struct BulletClothSetup {
    const Eigen::VectorXd& mass;  ///< `[V]` [kg]
    const std::vector<int>& pinned;
    const std::vector<Spring>& springs;
    Eigen::Vector3d gravity;  ///< [m/s^2]
    double time_step;         ///< of a substep [s]
    int passes;               ///< over links and contacts in a substep
};

/// A btSoftBody (double precision) and the solver that fills its contacts: the one place that knows Bullet. Stepped as
/// btSoftRigidDynamicsWorld steps it, without broad phase: every solid of a scene is near.
///
/// A link's kLST in [0, 1] is the share of its length error that one pass removes. For a spring of stiffness K between
/// inverse masses w, implicit Euler removes K h² w / (1 + K h² w) in a substep h, which n passes share:
/// kLST = 1 − (1 + K h² w)^(−1/n).
///
/// Each pass goes over links, rigid contacts, and four times over soft contacts: one would leave some of them crossing
/// where many meet.
class BulletCloth {
  public:
    /// At x `[V x 3]`, at rest. What it touches, and the report it adds its times to, must outlive it.
    BulletCloth(const BulletClothSetup& setup, const Positions& x, std::vector<SolidTouches>& solids,
                std::optional<SheetTouches>& sheet, DrapeReport& report);
    ~BulletCloth();

    /// Mass-proportional [1/s]; and the share of its velocity that what touches itself keeps in a substep.
    void set_damping(double damping, double kept_by_sheet);
    /// Another force on each vertex `[V x 3]` [N], in the next substep.
    void add_force(const Positions& force);
    void substep();

    struct State {
        Positions position, before, velocity;  ///< `before`: where the last substep began
    };
    State state() const;
    void set_state(const State& state);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::simulate
