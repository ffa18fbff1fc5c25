#pragma once

#include <optional>

#include "simulate/drape_model.h"
#include "simulate/implicit_step.h"
#include "simulate/solver.h"

namespace toile::simulate {

/// `implicit`: implicit Euler steps along the path, a few Newton iterations each; then pseudo-transient continuation,
/// one Newton iteration a step, whose time step grows up to statics.
class ImplicitSolver final : public Solver {
  public:
    ImplicitSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report);

    void start(const Positions& x) override;
    void follow(const Positions& carried) override;
    void settle() override;
    const Positions& position() const override { return x_; }
    double residual_force() override;
    double largest_speed() override { return speeds().maxCoeff(); }
    Eigen::VectorXd speeds() override;
    double energy() const override;
    double held_by_friction() const override;

  private:
    void begin_step();
    void end_step();
    void carry(const Positions& carried);

    const DrapeModel& model_;
    std::vector<Contact*> contacts_;
    DrapeReport& report_;
    std::optional<SelfContact> self_contact_;
    std::optional<Wind> wind_;
    ImplicitStep step_;
    Positions x_, inertial_, velocity_, before_;
    double time_step_ = 0.0;      ///< of the next settling step [s]
    double last_residual_ = 0.0;  ///< kept in wind alone [N]
};

}  // namespace toile::simulate
