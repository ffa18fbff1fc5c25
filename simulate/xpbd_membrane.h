#pragma once

#include <functional>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "cloth/lane_array.h"
#include "cloth/membrane.h"
#include "simulate/xpbd_batches.h"
#include "simulate/xpbd_mobility.h"

namespace toile::simulate {

/// The membrane's energy, without its squeeze, as compliant constraints: one block for a triangle's three strains, as
/// `XpbdConstraints` has it. Eight triangles at a time.
class XpbdMembrane {
  public:
    XpbdMembrane(const ClothMesh& mesh, const MembraneStiffness& stiffness);

    /// Scales down forces `[F x 3]` that are too large to lag behind by a step, and adds those on the vertices.
    void begin(const XpbdMobility& mobility, const Positions& start, Positions& force, Positions& total) const;

    struct Sweep {
        const Positions& start;
        Positions& force;
        Positions& x;
        /// Called, if it is not empty, after a triangle that is squeezed now, or has a number other than 0 in `also`.
        std::function<void(int triangle)> squeezed;
        const double* also;
    };
    void sweep(const XpbdMobility& mobility, const Sweep& sweep) const;
    void follow(const XpbdMobility& mobility, const Positions& reached, Positions& kept) const;

  private:
    void respond(const XpbdBatch<3>& batch, const Positions& x, double* response) const;

    MembraneStiffness stiffness_;
    std::vector<MembraneStencil> stencil_;
    std::vector<XpbdBatch<3>> batch_;
    LaneArray constants_;  // of each batch: gradients (u of three corners, v of three), their lengths, area
};

/// A kept force whose direction lags behind by a step is stable up to q/m times its geometric stiffness of 4; this is
/// for one triangle of those around a vertex.
constexpr double largest_lag = 2.0;

}  // namespace toile::simulate
