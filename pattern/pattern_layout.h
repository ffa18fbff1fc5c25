#pragma once

#include <vector>

#include "cloth/cloth_mesh.h"

namespace toile::pattern {

enum class ImageLayout {
    layers,  ///< each chart has a layer of its own
    atlas,   ///< all charts side by side in one layer
};

/// Pixels kept free around each chart, for values that go on beyond its edge: charts are at least twice this apart.
inline constexpr int chart_margin = 2;

/// Where the pattern lies in an image of `layers` layers of `size` x `size` pixels, all at one scale. Columns run along
/// u, rows against v, so that a row's picture is upright; pixel centres are at whole numbers.
struct PatternLayout {
    int size = 0;
    int layers = 0;
    double pixel = 0;  ///< side of a pixel on the pattern [m]
    Positions
        pattern_pixel;  ///< `[P x 3]` layer, column, row of each pattern position (contract, /image/pattern_pixel)
};

/// Charts are the connected parts of the pattern; `[F]` chart of each pattern triangle, numbered by panel, then by
/// first triangle. With `triangle_panel` empty by first triangle alone.
std::vector<int> pattern_charts(const ClothMesh& mesh, const std::vector<int>& triangle_panel);

/// Largest uniform scale at which the charts fit. Throws Error if `size` leaves a chart no room (below 8 pixels, or too
/// many charts for one atlas of this size).
PatternLayout lay_out(const ClothMesh& mesh, const std::vector<int>& chart, ImageLayout layout, int size);

}  // namespace toile::pattern
