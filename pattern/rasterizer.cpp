#include "pattern/rasterizer.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace toile::pattern {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A pattern triangle in pixel coordinates, and barycentric coordinates in it as affine functions.
struct PixelTriangle {
    std::array<Vector2d, 3> corner;
    Eigen::Matrix2d inverse;  ///< (x - corner 0) to the weights of corners 1 and 2

    Vector3d barycentric(const Vector2d& x) const {
        const Vector2d w = inverse * (x - corner[0]);
        return {1 - w.x() - w.y(), w.x(), w.y()};
    }
};

/// False for a triangle without area.
bool make_triangle(const ClothMesh& mesh, const PatternLayout& layout, int f, PixelTriangle& triangle) {
    for (int k = 0; k < 3; ++k)
        triangle.corner[k] = layout.pattern_pixel.row(mesh.pattern_triangle(f, k)).tail<2>().transpose();
    Eigen::Matrix2d side;
    side << triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0];
    if (!(std::abs(side.determinant()) > 1e-9 * side.squaredNorm())) return false;
    triangle.inverse = side.inverse();
    return true;
}

/// The point of the triangle nearest to x, which lies outside.
Vector2d nearest_on_border(const PixelTriangle& triangle, const Vector2d& x) {
    Vector2d nearest = triangle.corner[0];
    for (int k = 0; k < 3; ++k) {
        const Vector2d a = triangle.corner[k], side = triangle.corner[(k + 1) % 3] - a;
        const Vector2d on = a + std::clamp((x - a).dot(side) / side.squaredNorm(), 0.0, 1.0) * side;
        if ((on - x).squaredNorm() < (nearest - x).squaredNorm()) nearest = on;
    }
    return nearest;
}

/// Weights of the linear continuation, shortened where a sliver would make it run away.
Vector3d continued(const PixelTriangle& triangle, const Vector2d& x, const Vector2d& border) {
    const Vector3d at_border = triangle.barycentric(border).cwiseMax(0.0);
    const Vector3d beyond = triangle.barycentric(x) - at_border;
    const double reach = beyond.cwiseAbs().maxCoeff();
    constexpr double longest = 2.0;
    return at_border + (reach > longest ? longest / reach : 1.0) * beyond;
}

struct PixelSource {
    double squared_distance = std::numeric_limits<double>::infinity();  ///< to the triangle [pixel^2], 0 inside
    int triangle = -1;
    Vector3d weight = Vector3d::Zero();
};

void splat(const PixelTriangle& triangle, int f, int layer, int size, std::vector<PixelSource>& source) {
    Vector2d low = triangle.corner[0], high = low;
    for (const Vector2d& c : triangle.corner) {
        low = low.cwiseMin(c);
        high = high.cwiseMax(c);
    }
    auto whole = [size](double x) { return std::clamp(static_cast<int>(x), 0, size - 1); };
    for (int row = whole(std::ceil(low.y() - chart_margin)); row <= whole(std::floor(high.y() + chart_margin)); ++row) {
        for (int column = whole(std::ceil(low.x() - chart_margin));
             column <= whole(std::floor(high.x() + chart_margin)); ++column) {
            PixelSource& pixel = source[(static_cast<size_t>(layer) * size + row) * size + column];
            if (pixel.squared_distance == 0) continue;
            const Vector2d x(column, row);
            const Vector3d inside = triangle.barycentric(x);
            if (inside.minCoeff() >= 0) {
                pixel = {0, f, inside};
                continue;
            }
            const Vector2d border = nearest_on_border(triangle, x);
            const double squared_distance = (border - x).squaredNorm();
            if (squared_distance < pixel.squared_distance && squared_distance > 0)
                pixel = {squared_distance, f, continued(triangle, x, border)};
        }
    }
}

}  // namespace

Raster rasterize(const ClothMesh& mesh, const PatternLayout& layout) {
    const int size = layout.size;
    std::vector<PixelSource> source(static_cast<size_t>(layout.layers) * size * size);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        PixelTriangle triangle;
        if (!make_triangle(mesh, layout, f, triangle)) continue;
        splat(triangle, f, static_cast<int>(layout.pattern_pixel(mesh.pattern_triangle(f, 0), 0)), size, source);
    }
    Raster raster;
    raster.mask.assign(source.size(), 0);
    std::vector<Eigen::Triplet<double>> entry;
    constexpr double reach = (chart_margin + 0.01) * (chart_margin + 0.01) * 2;  // a margin along both axes
    for (size_t i = 0; i < source.size(); ++i) {
        if (source[i].triangle < 0 || source[i].squared_distance > reach) continue;
        raster.mask[i] = source[i].squared_distance == 0;
        for (int k = 0; k < 3; ++k)
            entry.emplace_back(static_cast<int>(i), mesh.triangle(source[i].triangle, k), source[i].weight[k]);
    }
    raster.vertex_to_pixel.resize(static_cast<Eigen::Index>(source.size()), mesh.vertex_count());
    raster.vertex_to_pixel.setFromTriplets(entry.begin(), entry.end());
    return raster;
}

PixelWeights reading_weights(const ClothMesh& mesh, const PatternLayout& layout) {
    std::set<std::pair<int, int>> pair;  // vertex, pattern position
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int k = 0; k < 3; ++k) pair.emplace(mesh.triangle(f, k), mesh.pattern_triangle(f, k));
    std::vector<int> count(static_cast<size_t>(mesh.vertex_count()), 0);
    for (const auto& [v, p] : pair) ++count[v];
    std::vector<Eigen::Triplet<double>> entry;
    for (const auto& [v, p] : pair) {
        const Vector3d at = layout.pattern_pixel.row(p).transpose();
        const int column = std::clamp(static_cast<int>(std::floor(at.y())), 0, layout.size - 2);
        const int row = std::clamp(static_cast<int>(std::floor(at.z())), 0, layout.size - 2);
        const double x = at.y() - column, y = at.z() - row;
        const int first = (static_cast<int>(at.x()) * layout.size + row) * layout.size + column;
        const double share = 1.0 / count[v];
        entry.emplace_back(v, first, share * (1 - x) * (1 - y));
        entry.emplace_back(v, first + 1, share * x * (1 - y));
        entry.emplace_back(v, first + layout.size, share * (1 - x) * y);
        entry.emplace_back(v, first + layout.size + 1, share * x * y);
    }
    PixelWeights weights(mesh.vertex_count(), static_cast<Eigen::Index>(layout.layers) * layout.size * layout.size);
    weights.setFromTriplets(entry.begin(), entry.end());
    return weights;
}

Positions read_image(const PixelWeights& reading, const std::vector<float>& image, int layers, int size) {
    const size_t area = static_cast<size_t>(size) * size;
    Positions value(static_cast<Eigen::Index>(area) * layers, 3);
    for (int layer = 0; layer < layers; ++layer)
        for (int component = 0; component < 3; ++component)
            for (size_t i = 0; i < area; ++i)
                value(static_cast<Eigen::Index>(layer * area + i), component) =
                    image[(3 * layer + component) * area + i];
    return reading * value;
}

}  // namespace toile::pattern
