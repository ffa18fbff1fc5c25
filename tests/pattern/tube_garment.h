#pragma once

#include <cmath>
#include <numbers>

#include "files/mesh_file.h"
#include "skin/body.h"

namespace toile::pattern {

/// A tube of cloth about the y axis as a file holds it: two panels, front and back, with their own vertices along the
/// two seams, wound outwards, texture in units of `unit` metres.
inline files::MeshData tube_garment(double radius = 0.2, double height = 0.4, double unit = 2.0, int around = 12,
                                    int up = 8) {
    files::MeshData mesh;
    const int columns = around + 1, rows = up + 1;
    mesh.position.resize(2 * columns * rows, 3);
    mesh.texture.resize(2 * columns * rows, 2);
    mesh.triangle.resize(4 * around * up, 3);
    mesh.part_name = {"front", "back"};
    int f = 0;
    for (int panel = 0; panel < 2; ++panel) {
        for (int j = 0; j < rows; ++j) {
            for (int i = 0; i < columns; ++i) {
                // Whole steps, so that both panels compute the same seam positions.
                const int step = (panel * around + i) % (2 * around);
                const double angle = std::numbers::pi * step / around;
                const int row = (panel * rows + j) * columns + i;
                mesh.position.row(row) << -radius * std::cos(angle), height * j / up, radius * std::sin(angle);
                mesh.texture.row(row) << (0.1 * panel + radius * std::numbers::pi * i / around) / unit,
                    (1.0 * panel + height * j / up) / unit;
            }
        }
        for (int j = 0; j < up; ++j) {
            for (int i = 0; i < around; ++i) {
                const int a = (panel * rows + j) * columns + i;
                mesh.triangle.row(f++) << a, a + 1, a + columns;
                mesh.triangle.row(f++) << a + 1, a + columns + 1, a + columns;
                mesh.part.insert(mesh.part.end(), 2, panel);
            }
        }
    }
    return mesh;
}

/// A closed cylinder about the y axis from `bottom` to `top`: a body's surface, without a skeleton.
inline skin::Body column_body(double radius, double bottom, double top, int around = 32, int up = 12) {
    skin::Body body;
    body.rest_position.resize(around * (up + 1) + 2, 3);
    body.triangle.resize(2 * around * (up + 1), 3);
    for (int j = 0; j <= up; ++j)
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            body.rest_position.row(j * around + i) << radius * std::sin(angle), bottom + (top - bottom) * j / up,
                radius * std::cos(angle);
        }
    const int low = around * (up + 1), high = low + 1;
    body.rest_position.row(low) << 0, bottom, 0;
    body.rest_position.row(high) << 0, top, 0;
    int f = 0;
    for (int i = 0; i < around; ++i) {
        const int next = (i + 1) % around;
        for (int j = 0; j < up; ++j) {
            body.triangle.row(f++) << j * around + i, j * around + next, (j + 1) * around + i;
            body.triangle.row(f++) << j * around + next, (j + 1) * around + next, (j + 1) * around + i;
        }
        body.triangle.row(f++) << low, next, i;
        body.triangle.row(f++) << high, up * around + i, up * around + next;
    }
    return body;
}

}  // namespace toile::pattern
