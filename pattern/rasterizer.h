#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "pattern/pattern_layout.h"

namespace toile::pattern {

/// One weight matrix each way between values at mesh vertices and values at pixels, row-major sparse; a pixel's index
/// is (layer * size + row) * size + column.
using PixelWeights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct Raster {
    PixelWeights vertex_to_pixel;  ///< `[pixels x V]`
    std::vector<uint8_t> mask;     ///< `[pixels]` 1 where a pattern triangle covers the pixel's centre
};

/// Barycentric weights of the pattern triangle that covers each pixel's centre. Pixels up to `chart_margin` beyond an
/// edge take the linear continuation of the nearest triangle, so that bilinear reading up to the edge sees no break; no
/// pixel takes values of two charts. Triangles without area are passed over.
Raster rasterize(const ClothMesh& mesh, const PatternLayout& layout);

/// `[V x pixels]`: bilinear reading at each pattern position, averaged over those of a vertex (contract).
PixelWeights reading_weights(const ClothMesh& mesh, const PatternLayout& layout);

/// Displacements `[V x 3]` [m] that an image `[3 layers x size x size]`, channel 3·layer + component, holds; `reading`
/// as `reading_weights` gives it.
Positions read_image(const PixelWeights& reading, const std::vector<float>& image, int layers, int size);

}  // namespace toile::pattern
