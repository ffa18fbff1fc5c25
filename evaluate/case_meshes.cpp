#include "evaluate/case_meshes.h"

#include <cmath>
#include <numbers>
#include <random>

namespace toile::evaluate {
namespace {

/// Two triangles for each cell of a grid whose rows hold `row` vertices.
Triangles grid_triangles(int row, int rows) {
    Triangles triangle(2 * (row - 1) * (rows - 1), 3);
    int f = 0;
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < row; ++i) {
            const int a = j * row + i, b = a + 1, c = a + row, d = c + 1;
            const bool even = (i + j) % 2 == 0;
            triangle.row(f++) << a, b, (even ? c : d);
            triangle.row(f++) << (even ? b : a), d, c;
        }
    }
    return triangle;
}

}  // namespace

std::vector<double> even_lines(int cells, double length) {
    std::vector<double> line;
    for (int i = 0; i <= cells; ++i) line.push_back(length * i / cells);
    return line;
}

ClothMesh grid_cloth(const std::vector<double>& u, const std::vector<double>& v, double height,
                     double density_per_area) {
    ClothMesh mesh;
    const int row = static_cast<int>(u.size()), rows = static_cast<int>(v.size());
    mesh.rest_position.resize(row * rows, 3);
    mesh.pattern_position.resize(row * rows, 2);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < row; ++i) {
            mesh.pattern_position.row(j * row + i) << u[i], v[j];
            mesh.rest_position.row(j * row + i) << u[i] - 0.5 * u.back(), height, 0.5 * v.back() - v[j];
        }
    }
    mesh.triangle = mesh.pattern_triangle = grid_triangles(row, rows);
    mesh.mass = lumped_mass(mesh, density_per_area);
    return mesh;
}

ClothMesh graded_disc(int sectors, double inner_radius, double outer_radius, double height, double density_per_area) {
    const double turn = 2.0 * std::numbers::pi / sectors;
    const int rings = 1 + static_cast<int>(std::lround(std::log(outer_radius / inner_radius) / std::log1p(turn)));
    const double growth = std::pow(outer_radius / inner_radius, 1.0 / (rings - 1));
    ClothMesh mesh;
    mesh.pattern_position.resize(1 + sectors * rings, 2);
    mesh.pattern_position.row(0).setZero();
    for (int j = 0; j < rings; ++j) {
        const double radius = inner_radius * std::pow(growth, j);
        for (int i = 0; i < sectors; ++i)
            mesh.pattern_position.row(1 + j * sectors + i) << radius * std::cos(turn * (i + 0.5 * j)),
                radius * std::sin(turn * (i + 0.5 * j));
    }
    mesh.rest_position.resize(mesh.pattern_position.rows(), 3);
    mesh.rest_position.col(0) = mesh.pattern_position.col(0);
    mesh.rest_position.col(1).setConstant(height);
    mesh.rest_position.col(2) = -mesh.pattern_position.col(1);
    mesh.triangle.resize(sectors * (2 * rings - 1), 3);
    int f = 0;
    for (int i = 0; i < sectors; ++i) mesh.triangle.row(f++) << 0, 1 + i, 1 + (i + 1) % sectors;
    // Each ring is turned by half a sector against the last: a vertex sits over the middle of the inner edge after it.
    for (int j = 0; j + 1 < rings; ++j) {
        for (int i = 0; i < sectors; ++i) {
            const int next = (i + 1) % sectors, in = 1 + j * sectors, out = in + sectors;
            mesh.triangle.row(f++) << in + i, out + i, in + next;
            mesh.triangle.row(f++) << in + next, out + i, out + next;
        }
    }
    mesh.pattern_triangle = mesh.triangle;
    mesh.mass = lumped_mass(mesh, density_per_area);
    return mesh;
}

void shake(Positions& x, double size, std::uint64_t seed) {
    std::mt19937_64 draw(seed);
    // std::uniform_real_distribution differs between libraries; this does not.
    const double unit = std::ldexp(1.0, -53);
    for (Eigen::Index k = 0; k < x.size(); ++k)
        x.data()[k] += size * (2.0 * unit * static_cast<double>(draw() >> 11) - 1.0);
}

}  // namespace toile::evaluate
