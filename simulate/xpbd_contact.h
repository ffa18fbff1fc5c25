#pragma once

#include <vector>

#include "simulate/contact.h"
#include "simulate/xpbd_constraints.h"

namespace toile::simulate {

/// One point's contact with one solid: part of a state.
struct XpbdTouch {
    int piece = -1;
    Eigen::Vector3d sampled_at = Eigen::Vector3d::Zero();  ///< where the solid was looked up
    double distance = 0.0;                                 ///< there [m]
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    bool sampled = false;
    double pressing = 0.0;                               ///< multiplier: the normal force is this times gradient [N]
    Eigen::Vector3d friction = Eigen::Vector3d::Zero();  ///< on the point [N]
    bool anchored = false;
    double spring = 0.0;           ///< of sticking [N/m]
    Eigen::Vector3d anchor_local;  ///< in the piece's frame
    Eigen::Vector3d anchor;        ///< in the world, during this step
};

/// The contact and friction of `Contact`, one solid, as compliant constraints: the same points, the same pressure, the
/// same anchors. A touched point sees the solid as the plane of its last look-up, which is renewed at the start of a
/// step where the point has moved too far from it; along the normal its cubic energy is minimised exactly.
class XpbdContact {
  public:
    explicit XpbdContact(const Contact& contact) : contact_(&contact) {}

    std::vector<XpbdTouch> no_touches() const;
    /// The contact's ties are renewed, and the solid may have moved: takes pieces and anchors over.
    void tie(bool solid_moved, std::vector<XpbdTouch>& touches) const;
    /// Keeps anchors in their pieces' frames: before the solid moves.
    void keep_anchors(std::vector<XpbdTouch>& touches) const;

    /// Looks up the solid again where needed. Returns the indices of touches that may be felt in a step in which no
    /// point goes further than `largest_move` [m], 0 for no bound: what follows is about them.
    std::vector<int> begin(const Positions& x, double largest_move, std::vector<XpbdTouch>& touches) const;
    /// The forces of the last step.
    void add_forces(const std::vector<int>& near, const std::vector<XpbdTouch>& touches, Positions& total) const;
    void sweep(const XpbdMobility& mobility, const std::vector<int>& near, std::vector<XpbdTouch>& touches,
               Positions& x) const;
    /// Anchors of sliding points follow.
    void end(const std::vector<int>& near, const Positions& x, std::vector<XpbdTouch>& touches) const;

    /// The energy's forces at x, friction from the anchors there are.
    void add_static_forces(const Positions& x, const std::vector<XpbdTouch>& touches, Positions& total) const;

  private:
    const Contact* contact_;
};

}  // namespace toile::simulate
