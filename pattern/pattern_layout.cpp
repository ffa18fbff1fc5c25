#include "pattern/pattern_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "cloth/error.h"
#include "cloth/topology.h"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace toile::pattern {
namespace {

using Box = Eigen::AlignedBox2d;

std::vector<Box> chart_boxes(const ClothMesh& mesh, const std::vector<int>& chart) {
    std::vector<Box> box(chart.empty() ? 0 : 1 + *std::max_element(chart.begin(), chart.end()));
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            box[chart[f]].extend(mesh.pattern_position.row(mesh.pattern_triangle(f, corner)).transpose());
    return box;
}

/// Layer and the pixel of the lower left corner of each chart's box, at whole numbers.
struct Placement {
    std::vector<std::array<int, 3>> corner;  ///< layer, column, row from below
    int layers = 0;
};

/// Whole pixels a length takes, with its margins.
int pixels(double length, double pixel) {
    return static_cast<int>(std::ceil(length / pixel)) + 1 + 2 * chart_margin;
}

Placement place_layers(size_t charts) {
    Placement placement;
    placement.layers = static_cast<int>(charts);
    for (int c = 0; c < placement.layers; ++c) placement.corner.push_back({c, chart_margin, chart_margin});
    return placement;
}

std::optional<Placement> place_atlas(const std::vector<Box>& box, int size, double pixel) {
    std::vector<stbrp_rect> rectangle(box.size());
    for (size_t c = 0; c < box.size(); ++c) {
        const Eigen::Vector2d extent = box[c].sizes();
        rectangle[c] = {static_cast<int>(c), pixels(extent.x(), pixel), pixels(extent.y(), pixel), 0, 0, 0};
        if (rectangle[c].w > size || rectangle[c].h > size) return std::nullopt;
    }
    stbrp_context context;
    std::vector<stbrp_node> node(static_cast<size_t>(size));
    stbrp_init_target(&context, size, size, node.data(), size);
    if (!stbrp_pack_rects(&context, rectangle.data(), static_cast<int>(rectangle.size()))) return std::nullopt;
    Placement placement;
    placement.layers = 1;
    for (const stbrp_rect& r : rectangle) placement.corner.push_back({0, r.x + chart_margin, r.y + chart_margin});
    return placement;
}

/// The smallest pixel at which an atlas of the charts fits, found by bisection.
std::pair<Placement, double> pack_atlas(const std::vector<Box>& box, int size, double smallest) {
    double fits = smallest;
    std::optional<Placement> best;
    for (int doubling = 0; doubling < 24 && !best; ++doubling)
        if (!(best = place_atlas(box, size, fits))) fits *= 2;
    if (!best)
        throw Error("the pattern has " + std::to_string(box.size()) + " parts, too many for an atlas of " +
                        std::to_string(size) + " pixels",
                    "image.size", "choose a larger image.size, or image.layout = \"layers\"");
    double too_small = fits / 2;
    for (int step = 0; step < 20 && fits > smallest; ++step) {
        const double middle = 0.5 * (too_small + fits);
        if (auto placed = place_atlas(box, size, middle)) {
            best = std::move(placed);
            fits = middle;
        } else {
            too_small = middle;
        }
    }
    return {*best, fits};
}

}  // namespace

std::vector<int> pattern_charts(const ClothMesh& mesh, const std::vector<int>& triangle_panel) {
    const std::vector<int> part =
        connected_components(mesh.pattern_triangle, static_cast<int>(mesh.pattern_position.rows()));
    std::map<int, std::pair<int, int>> first;  // part -> (panel, triangle)
    for (int f = 0; f < mesh.triangle_count(); ++f)
        first.try_emplace(part[mesh.pattern_triangle(f, 0)], triangle_panel.empty() ? 0 : triangle_panel[f], f);
    std::vector<std::pair<std::pair<int, int>, int>> order;
    for (const auto& [p, key] : first) order.emplace_back(key, p);
    std::sort(order.begin(), order.end());
    std::map<int, int> number;
    for (const auto& [key, p] : order) number.emplace(p, static_cast<int>(number.size()));
    std::vector<int> chart(static_cast<size_t>(mesh.triangle_count()));
    for (int f = 0; f < mesh.triangle_count(); ++f) chart[f] = number.at(part[mesh.pattern_triangle(f, 0)]);
    return chart;
}

PatternLayout lay_out(const ClothMesh& mesh, const std::vector<int>& chart, ImageLayout layout, int size) {
    const std::vector<Box> box = chart_boxes(mesh, chart);
    const int room = size - 1 - 2 * chart_margin;
    if (size < 8) throw Error("an image of " + std::to_string(size) + " pixels is too small", "image.size");
    double longest = 0;
    for (const Box& b : box) longest = std::max(longest, b.sizes().maxCoeff());
    if (!(longest > 0)) throw Error("the pattern has no extent", "pattern");
    PatternLayout result;
    result.size = size;
    result.pixel = longest / room;
    Placement placement = place_layers(box.size());
    if (layout == ImageLayout::atlas) std::tie(placement, result.pixel) = pack_atlas(box, size, result.pixel);
    result.layers = placement.layers;
    // A pattern position that no triangle uses lies on the first margin.
    result.pattern_pixel.setZero(mesh.pattern_position.rows(), 3);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int p = mesh.pattern_triangle(f, corner);
            const auto& [layer, column, row] = placement.corner[chart[f]];
            const Eigen::Vector2d at = (mesh.pattern_position.row(p).transpose() - box[chart[f]].min()) / result.pixel;
            result.pattern_pixel.row(p) << layer, column + at.x(), size - 1 - (row + at.y());
        }
    }
    return result;
}

}  // namespace toile::pattern
