#pragma once

#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::pattern {

/// A garment ready to be draped. `mesh.rest_position` is where the drape in the neutral pose starts (outside the body),
/// until the neutral drape replaces it. Masses are empty until a material is chosen.
struct Garment {
    ClothMesh mesh;
    std::vector<int> triangle_panel;      ///< `[F]` panel of each triangle
    std::vector<std::string> panel_name;  ///< one a panel
    std::vector<std::string> remarks;     ///< what was mended or estimated on the way in, one sentence each
};

}  // namespace toile::pattern
