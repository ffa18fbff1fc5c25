#pragma once

#include "skin/body.h"

namespace toile::skin {

struct BuiltinBodyOptions {
    double height = 1.75;   ///< [m], 1.2 to 2.2
    double girth = 1.0;     ///< scales the thickness of trunk and limbs, 0.7 to 1.4
    double voxel = 0.0135;  ///< [m], resolution of the surface, 0.008 to 0.03
};

/// An adult humanoid made by code, without any asset: a closed surface of 8,000 to 15,000 vertices with the default
/// options, with smooth weights (at most four a vertex), all roles present under their own names, standing on y = 0 in
/// an A pose, facing +z. All joints have the world's axes. The same options give the same bytes. Throws Error for an
/// option out of range.
Body make_builtin_body(const BuiltinBodyOptions& options);

}  // namespace toile::skin
