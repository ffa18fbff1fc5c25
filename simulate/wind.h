#pragma once

#include "cloth/cloth_mesh.h"

namespace toile::simulate {

/// A steady, even wind.
struct WindOptions {
    Eigen::Vector3d velocity = {0.0, 0.0, 3.0};  ///< of the air [m/s], each within 100
    double drag = 1.2;                           ///< coefficient C_D, 0 to 10; about 1.2 for a plate across the wind
    double lift = 1.2;         ///< coefficient C_L, 0 to 10; equal to C_D, the force is normal to the cloth
    double air_density = 1.2;  ///< [kg/m^3], 0 to 10: air at 20 °C
};

/// Force of the wind on each triangle of area A and normal n, from the air's velocity u relative to it, n turned to the
/// side u blows to, cos α = n·u / |u|:
///
///     f = ½ ρ A |u|² cos α (C_D cos α û + C_L (n − cos α û))     [N], a third to each corner
///
/// With C_D = C_L that is the pressure ½ ρ C_D |u|² cos α along n, which a plate in oblique wind feels. Both sides
/// alike, no shelter of cloth by cloth or body. No potential has this force: it is taken at one state, and kept until
/// the next `linearise`. State of one drape.
class Wind {
  public:
    Wind(const ClothMesh& mesh, const WindOptions& options);

    /// The cloth at x `[V x 3]`, moving at `velocity` `[V x 3]` [m/s]; at rest without it.
    void linearise(const Positions& x, const Positions* velocity = nullptr);
    /// The work the force does on the way to x is the negative of this [J].
    double energy(const Positions& x) const { return -force_.cwiseProduct(x).sum(); }
    void add_gradient(Positions& gradient) const { gradient -= force_; }
    /// `[V x 3]` [N].
    const Positions& force() const { return force_; }

  private:
    const ClothMesh& mesh_;
    WindOptions options_;
    Positions force_;
};

}  // namespace toile::simulate
