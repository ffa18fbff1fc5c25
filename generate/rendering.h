#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloth/types.h"
#include "files/image_file.h"
#include "generate/drawing.h"

namespace toile::generate {

/// A surface with a colour at each vertex.
struct RenderedSurface {
    Triangles triangle;        ///< `[F x 3]`
    Positions position;        ///< `[V x 3]` [m]
    std::vector<Color> color;  ///< `[V]`
};

/// What the picture shows: seen from +z along -z, x to the right, y up, without perspective.
struct FrontView {
    Eigen::Vector2d centre{0, 0};  ///< x and y in the middle of the picture [m]
    Color ground{1, 1, 1};
    double metres_per_pixel = 0.002;
    int width = 240, height = 320;  ///< [pixels]
};

/// Draws surfaces on the ground's colour with a depth buffer and soft light from above the viewer; edges are smoothed.
files::Picture render(const std::vector<RenderedSurface>& surface, const FrontView& view);

}  // namespace toile::generate
