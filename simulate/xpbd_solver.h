#pragma once

#include <optional>

#include "simulate/drape_model.h"
#include "simulate/solver.h"
#include "simulate/wind.h"
#include "simulate/xpbd_step.h"

namespace toile::simulate {

/// `xpbd`: extended position-based dynamics with small steps (Macklin et al. 2016, 2019) on the energies of `implicit`,
/// so that both come to rest in the same minima.
///
/// A path step is `xpbd.substeps` small steps. A settling step is one path step on the spot with kinetic damping
/// (dynamic relaxation, Cundall 1976; Barnes 1999): where the kinetic energy has passed a peak the cloth is stopped,
/// for there its energy is near a minimum along its way.
class XpbdSolver final : public Solver {
  public:
    XpbdSolver(const DrapeModel& model, const std::vector<Contact*>& contacts, DrapeReport& report);

    void start(const Positions& x) override;
    void follow(const Positions& carried) override;
    void settle() override;
    const Positions& position() const override { return state_.position; }
    double residual_force() override;
    double largest_speed() override;

  private:
    void tie(bool solids_moved);
    void carry(const Positions& carried);
    void blow();
    void keep_anchors();
    void soften(double fall);
    /// Sets masses of which q/m times the stiffness is no more than that.
    void add_mass(double relative_stiffness, XpbdParameters& parameters);

    const DrapeModel& model_;
    std::vector<Contact*> contacts_;
    DrapeReport& report_;
    std::optional<XpbdSelfContact> self_contact_;
    std::optional<Wind> wind_;
    XpbdSystem system_;
    XpbdParameters parameters_, settling_;
    XpbdState state_;
    double relative_stiffness_ = 0.0;  ///< while settling: q/m times stiffness, at most
    double kinetic_energy_ = 0.0;      ///< after the last small step while settling
};

}  // namespace toile::simulate
