#pragma once

#include <optional>

namespace toile::simulate {

/// Orthotropic membrane in the pattern's axes (u = weft, v = warp), per unit of pattern area. Defaults: a cotton
/// jersey.
struct MembraneOptions {
    double density_per_area = 0.18;  ///< [kg/m^2], 0.001 to 100
    double warp_stiffness = 1000.0;  ///< along v [N/m], above 0
    double weft_stiffness = 1000.0;  ///< along u [N/m], above 0
    double shear_stiffness = 300.0;  ///< [N/m], above 0
    double poisson_ratio = 0.3;      ///< coupling of warp and weft, 0 to 0.49
};

/// Hinge bending: rest angles are those of the flat pattern (zero).
struct BendingOptions {
    double stiffness = 2e-5;  ///< [N m], above 0
};

}  // namespace toile::simulate
