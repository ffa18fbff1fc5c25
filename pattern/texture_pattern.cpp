#include "pattern/texture_pattern.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "pattern/sewing.h"

namespace toile::pattern {
namespace {

double signed_area(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b, const Eigen::RowVector2d& c) {
    return 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

/// -1, 0 or 1 for each triangle: whether its texture runs the same way round as in space.
std::vector<int> orientations(const PlanePositions& corner, const std::string& where) {
    std::vector<int> sign(static_cast<size_t>(corner.rows() / 3));
    int flat = 0, first = -1;
    for (int f = 0; f < static_cast<int>(sign.size()); ++f) {
        const Eigen::RowVector2d a = corner.row(3 * f), b = corner.row(3 * f + 1), c = corner.row(3 * f + 2);
        const double area = signed_area(a, b, c);
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        // A texture triangle whose height is less than a thousandth of its longest side carries no shape.
        const bool has_area = std::abs(area) > 0.5e-3 * longest * longest && std::isfinite(area);
        sign[f] = !has_area ? 0 : area > 0.0 ? 1 : -1;
        flat += !has_area;
        if (!has_area && first < 0) first = f;
    }
    if (flat > 0)
        throw Error(
            "triangle " + std::to_string(first) + " has no area in its texture coordinates" +
                (flat > 1 ? " (" + std::to_string(flat) + " triangles have none)" : ""),
            where,
            "the texture coordinates are the garment's pattern: unwrap it so that each triangle keeps its shape");
    return sign;
}

/// Pattern indices: corners are one where vertex, texture coordinates and orientation are.
Triangles pattern_indices(const Triangles& triangle, const PlanePositions& corner, const std::vector<int>& sign,
                          PlanePositions& position) {
    const double extent = (corner.colwise().maxCoeff() - corner.colwise().minCoeff()).norm();
    std::map<std::tuple<int, int>, std::vector<int>> at_vertex;
    std::vector<Eigen::RowVector2d> points;
    Triangles pattern(triangle.rows(), 3);
    for (int f = 0; f < triangle.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d uv = corner.row(3 * f + k);
            std::vector<int>& candidates = at_vertex[{triangle(f, k), sign[f]}];
            const auto same = std::find_if(candidates.begin(), candidates.end(),
                                           [&](int p) { return (points[p] - uv).norm() <= 1e-6 * extent; });
            if (same == candidates.end()) {
                candidates.push_back(static_cast<int>(points.size()));
                pattern(f, k) = static_cast<int>(points.size());
                points.push_back(uv);
            } else {
                pattern(f, k) = *same;
            }
        }
    }
    position.resize(static_cast<int>(points.size()), 2);
    for (size_t p = 0; p < points.size(); ++p) position.row(static_cast<int>(p)) = points[p];
    return pattern;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Lengths in space over lengths in texture, for each triangle.
std::vector<double> scales(const Triangles& triangle, const Positions& rest, const PlanePositions& corner) {
    std::vector<double> scale(static_cast<size_t>(triangle.rows()));
    for (int f = 0; f < triangle.rows(); ++f) {
        double space = 0.0, texture = 0.0;
        for (int k = 0; k < 3; ++k) {
            space += (rest.row(triangle(f, k)) - rest.row(triangle(f, (k + 1) % 3))).norm();
            texture += (corner.row(3 * f + k) - corner.row(3 * f + (k + 1) % 3)).norm();
        }
        scale[f] = space / texture;
    }
    return scale;
}

/// Scale of each panel, and what to say about it.
std::vector<double> panel_scales(const std::vector<double>& triangle_scale, const std::vector<int>& triangle_panel,
                                 int panels, std::vector<std::string>& remarks) {
    const double overall = median(triangle_scale);
    std::ostringstream text;
    text.precision(4);
    if (overall > 0.9 && overall < 1.1) {
        text << "texture coordinates are taken as metres: lengths in space are " << overall << " times theirs";
        remarks.push_back(text.str());
        return std::vector<double>(static_cast<size_t>(panels), 1.0);
    }
    std::vector<std::vector<double>> of_panel(static_cast<size_t>(panels));
    for (size_t f = 0; f < triangle_scale.size(); ++f) of_panel[triangle_panel[f]].push_back(triangle_scale[f]);
    std::vector<double> scale;
    int own = 0;
    for (const std::vector<double>& values : of_panel) {
        const double here = median(values);
        // A panel of a few triangles has no reliable scale of its own.
        const bool differs = values.size() >= 8 && std::abs(here / overall - 1.0) > 0.15;
        own += differs;
        scale.push_back(differs ? here : overall);
    }
    text << "pattern scale estimated from the garment in space: " << overall << " m for a texture unit";
    if (own > 0) text << " (" << own << " of " << panels << " panels have a scale of their own)";
    remarks.push_back(text.str());
    return scale;
}

}  // namespace

TexturePattern panels_from_texture(const Triangles& triangle, const Positions& rest_position,
                                   const PlanePositions& corner_texture, double scale, const std::string& where) {
    const std::vector<int> sign = orientations(corner_texture, where);
    TexturePattern pattern;
    pattern.triangle = pattern_indices(triangle, corner_texture, sign, pattern.position);
    const std::vector<int> panel = connected_components(pattern.triangle, static_cast<int>(pattern.position.rows()));
    const int panels = 1 + *std::max_element(panel.begin(), panel.end());
    std::vector<bool> mirrored(static_cast<size_t>(panels), false);
    for (int f = 0; f < triangle.rows(); ++f) {
        pattern.triangle_panel.push_back(panel[pattern.triangle(f, 0)]);
        mirrored[pattern.triangle_panel[f]] = sign[f] < 0;
    }
    const std::vector<double> panel_scale = scale > 0.0 ? std::vector<double>(static_cast<size_t>(panels), scale)
                                                        : panel_scales(scales(triangle, rest_position, corner_texture),
                                                                       pattern.triangle_panel, panels, pattern.remarks);
    for (int p = 0; p < pattern.position.rows(); ++p) {
        pattern.position.row(p) *= panel_scale[panel[p]];
        if (mirrored[panel[p]]) pattern.position(p, 0) *= -1.0;
    }
    const auto turned = std::count(mirrored.begin(), mirrored.end(), true);
    if (turned > 0)
        pattern.remarks.push_back(std::to_string(turned) + " of " + std::to_string(panels) +
                                  " texture islands are mirrored; their u axis was turned round");
    lay_apart(pattern.position, panel, 0.05);
    return pattern;
}

}  // namespace toile::pattern
