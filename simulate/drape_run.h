#pragma once

#include <memory>
#include <vector>

#include "simulate/drape.h"
#include "simulate/drape_model.h"
#include "simulate/obstacle.h"
#include "simulate/solver.h"

namespace toile::simulate {

/// One drape under way: state, solids and workspace.
class DrapeRun {
  public:
    explicit DrapeRun(const DrapeModel& shared);

    /// Sets out from x, the body in its neutral pose.
    void start(const Positions& x, const skin::Pose& neutral);
    /// Follows the body along interpolated poses, carried by it, with inertia.
    void follow(const skin::Pose& from, const skin::Pose& to);
    /// Comes to rest where the body is now. Where the cloth then lies deeper in a solid than the gate allows, contact
    /// is made stiffer and it comes to rest again, as long as that helps.
    void settle(const EnergyWatch& watch = {});
    /// Certificate, status and report.
    DrapeResult finish();

  private:
    void add_contact(const Obstacle& obstacle);
    void tie_to_body(const Positions& x, const skin::Pose& neutral);
    double relative_residual();
    void come_to_rest(const EnergyWatch& watch);
    /// How deep the deepest vertex lies in any solid [m]: 0 where all are at least a share of the thickness outside.
    double deepest() const;
    void carry_with_body();
    double penetration() const;
    Certificate certify();

    const DrapeModel& shared_;
    const DrapeScene& scene_;
    std::unique_ptr<CollisionBody> body_;
    std::vector<std::unique_ptr<Obstacle>> solids_;
    std::vector<std::unique_ptr<Contact>> contacts_;
    DrapeReport report_;
    std::unique_ptr<Solver> solver_;
    Positions carried_;
};

}  // namespace toile::simulate
