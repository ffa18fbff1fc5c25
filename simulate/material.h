#pragma once

#include "cloth/membrane.h"

namespace toile::simulate {

/// Orthotropic membrane in the pattern's axes (u = weft, v = warp), per unit of pattern area. Defaults: round numbers
/// of a firm cotton; simulate/fabric.h has measured ones.
struct MembraneOptions {
    double density_per_area = 0.18;  ///< [kg/m^2], 0.001 to 100
    double warp_stiffness = 1000.0;  ///< along v [N/m], above 0
    double weft_stiffness = 1000.0;  ///< along u [N/m], above 0
    double shear_stiffness = 300.0;  ///< [N/m], above 0
    double poisson_ratio = 0.3;      ///< coupling of warp and weft, 0 to 0.49
    Compression compression = Compression::full;
};

/// Where a cloth's hinges have no moment.
enum class BendingRest {
    flat,   ///< in the flat pattern
    start,  ///< in the shape the garment starts from (`ClothMesh::rest_position`)
};

/// Hinge bending.
struct BendingOptions {
    double stiffness = 6e-5;  ///< bending rigidity [N m], above 0
    BendingRest rest = BendingRest::flat;
};

/// Largest stretches along the pattern's axes: beyond them the cloth stiffens without measure (cloth/strain_limit.h).
struct StrainLimitOptions {
    double warp = 1.1;  ///< along v, length over rest length, 1.001 to 10
    double weft = 1.1;  ///< along u
};

}  // namespace toile::simulate
