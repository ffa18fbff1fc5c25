#pragma once

#include "pattern/garment.h"

namespace toile::pattern {

enum class PatchOrientation {
    vertical,    ///< hangs down from y = 0, facing +z
    horizontal,  ///< lies on y = 0, facing +y, its top edge towards -z
};

struct PatchOptions {
    double width = 1.0;         ///< along x and u [m], 0.02 to 10
    double height = 1.0;        ///< along v [m], 0.02 to 10
    double edge_length = 0.03;  ///< of the triangles [m], 0.002 to 1, at most half of width and height
    PatchOrientation orientation = PatchOrientation::vertical;
};

/// A rectangle of cloth centred on x = 0, flat and at rest, of triangles that favour no direction. About
/// 1.15 width height / edge_length^2 vertices. Throws Error for options out of range.
Garment make_patch(const PatchOptions& options);

}  // namespace toile::pattern
