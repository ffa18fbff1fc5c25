#pragma once

#include <array>
#include <map>

#include "cloth/cloth_mesh.h"

namespace toile::pattern {

/// Two square panels of side 0.2 m, each `cells` x `cells`, side by side in space along x and sewn along the middle. In
/// the pattern they lie apart, and the triangles are jittered so that no vertex meets a pixel's centre by chance.
struct TwoPanels {
    ClothMesh mesh;
    std::vector<int> triangle_panel;
};

inline TwoPanels two_panels(int cells) {
    TwoPanels result;
    const int across = cells + 1;
    const double step = 0.2 / cells;
    auto vertex = [&](int panel, int i, int j) { return j * (2 * cells + 1) + panel * cells + i; };
    auto pattern = [&](int panel, int i, int j) { return panel * across * across + j * across + i; };
    ClothMesh& mesh = result.mesh;
    mesh.rest_position.setZero((2 * cells + 1) * across, 3);
    mesh.pattern_position.setZero(2 * across * across, 2);
    for (int panel = 0; panel < 2; ++panel) {
        for (int j = 0; j < across; ++j) {
            for (int i = 0; i < across; ++i) {
                const bool inner = i > 0 && i < cells && j > 0 && j < cells;
                const double u = i * step + (inner ? 0.2 * step * std::sin(3.7 * i + 1.3 * j + panel) : 0.0);
                const double v = j * step + (inner ? 0.2 * step * std::cos(2.1 * i + 4.9 * j + panel) : 0.0);
                mesh.rest_position.row(vertex(panel, i, j)) << panel * 0.2 + u, v, 0.0;
                mesh.pattern_position.row(pattern(panel, i, j)) << panel * 0.35 + u, v;
            }
        }
    }
    mesh.triangle.resize(4 * cells * cells, 3);
    mesh.pattern_triangle.resize(4 * cells * cells, 3);
    int f = 0;
    for (int panel = 0; panel < 2; ++panel) {
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                const std::array<std::array<int, 2>, 6> corner{
                    {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j}, {i + 1, j + 1}, {i, j + 1}}};
                for (int k = 0; k < 6; ++k) {
                    mesh.triangle(f + k / 3, k % 3) = vertex(panel, corner[k][0], corner[k][1]);
                    mesh.pattern_triangle(f + k / 3, k % 3) = pattern(panel, corner[k][0], corner[k][1]);
                }
                f += 2;
                result.triangle_panel.insert(result.triangle_panel.end(), 2, panel);
            }
        }
    }
    return result;
}

}  // namespace toile::pattern
