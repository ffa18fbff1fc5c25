#pragma once

#include <string>
#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::pattern {

/// Pattern panels from texture coordinates.
struct TexturePattern {
    PlanePositions position;          ///< `[P x 2]` [m], panels laid apart
    Triangles triangle;               ///< `[F x 3]`
    std::vector<int> triangle_panel;  ///< `[F]`
    std::vector<std::string> remarks;
};

/// Makes panels of texture islands. `triangle` `[F x 3]` and `rest_position` [m] are the sewn garment, wound
/// consistently; `corner_texture` `[3 F x 2]` the texture coordinates of the triangles' corners. Islands (and parts of
/// one island, where it is folded over itself) that run the other way round than in space have u turned round.
/// `scale` [m per texture unit], 0: the median over the triangles of lengths in space to lengths in texture, one where
/// that is 0.9 to 1.1, and an island's own median where it differs from all the others' by more than 15 %. Throws Error
/// naming triangles without area in texture.
TexturePattern panels_from_texture(const Triangles& triangle, const Positions& rest_position,
                                   const PlanePositions& corner_texture, double scale, const std::string& where);

}  // namespace toile::pattern
