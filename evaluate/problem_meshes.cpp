#include "evaluate/problem_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "cloth/topology.h"

namespace toile::evaluate {
namespace {

struct Grid {
    int columns, rows;
    bool closed;  ///< the last column meets the first
    int vertex(int i, int j) const { return j * columns + (closed ? i % columns : i); }
};

/// Two triangles for each square, along a diagonal that is drawn.
Triangles grid_triangles(const Grid& grid, Random& random) {
    const int squares = grid.closed ? grid.columns : grid.columns - 1;
    Triangles triangle(2 * squares * (grid.rows - 1), 3);
    int f = 0;
    for (int j = 0; j + 1 < grid.rows; ++j)
        for (int i = 0; i < squares; ++i) {
            const int a = grid.vertex(i, j), b = grid.vertex(i + 1, j), c = grid.vertex(i + 1, j + 1),
                      d = grid.vertex(i, j + 1);
            if (random.chance(0.5)) {
                triangle.row(f++) << a, b, c;
                triangle.row(f++) << a, c, d;
            } else {
                triangle.row(f++) << a, b, d;
                triangle.row(f++) << b, c, d;
            }
        }
    return triangle;
}

double signed_area(const Positions& position, int a, int b, int c) {
    const Eigen::RowVector3d u = position.row(b) - position.row(a), v = position.row(c) - position.row(a);
    return 0.5 * (u[0] * v[1] - u[1] * v[0]);
}

/// Flips edges of a flat mesh in the plane z = 0, none beside another, where both new triangles keep a tenth of the
/// area.
void flip_some_edges(ClothMesh& mesh, Random& random) {
    const Topology topology = build_topology(mesh.triangle);
    const auto hinges = build_hinges(topology, mesh.triangle);
    std::vector<char> used(mesh.triangle_count(), 0);
    int hinge = 0;
    for (Eigen::Index e = 0; e < topology.edge.rows(); ++e) {
        const int f = topology.edge_triangle(e, 0), g = topology.edge_triangle(e, 1);
        if (f < 0 || g < 0) continue;
        const int a = hinges(hinge, 0), b = hinges(hinge, 1), c = hinges(hinge, 2), d = hinges(hinge, 3);
        ++hinge;
        if (used[f] || used[g] || random.chance(0.3)) continue;
        const double first = signed_area(mesh.rest_position, c, d, b),
                     second = signed_area(mesh.rest_position, d, c, a);
        const double least = 0.1 * (std::abs(first) + std::abs(second));
        if (first * second <= 0 || std::min(std::abs(first), std::abs(second)) < least) continue;
        mesh.triangle.row(f) << c, first > 0 ? d : b, first > 0 ? b : d;
        mesh.triangle.row(g) << d, first > 0 ? c : a, first > 0 ? a : c;
        used[f] = used[g] = 1;
    }
}

/// Puts `piece` beside the pieces before it.
void append(ClothMesh& mesh, const ClothMesh& piece, double offset) {
    const Eigen::Index vertices = mesh.rest_position.rows(), triangles = mesh.triangle.rows();
    mesh.rest_position.conservativeResize(vertices + piece.rest_position.rows(), 3);
    mesh.rest_position.bottomRows(piece.rest_position.rows()) =
        piece.rest_position.rowwise() + Eigen::RowVector3d(offset, 0, 0);
    mesh.triangle.conservativeResize(triangles + piece.triangle.rows(), 3);
    mesh.triangle.bottomRows(piece.triangle.rows()) = piece.triangle.array() + static_cast<int>(vertices);
}

}  // namespace

ClothMesh open_tube(int around, int along, double edge_length, double shake, Random& random) {
    ClothMesh mesh;
    mesh.rest_position.resize(around * along, 3);
    const double radius = 0.5 * edge_length / std::sin(std::numbers::pi / around);
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * (i + random.uniform(-shake, shake)) / around;
            const double height = edge_length * (j + random.uniform(-shake, shake));
            mesh.rest_position.row(j * around + i) << radius * std::cos(angle), height, radius * std::sin(angle);
        }
    mesh.triangle = grid_triangles({around, along, true}, random);
    return mesh;
}

ClothMesh flat_patch(int columns, int rows, double edge_length, double shake, Random& random) {
    ClothMesh mesh;
    mesh.rest_position.resize(columns * rows, 3);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double x = i + random.uniform(-shake, shake), y = j + random.uniform(-shake, shake);
            mesh.rest_position.row(j * columns + i) << edge_length * x, edge_length * y, 0.0;
        }
    mesh.triangle = grid_triangles({columns, rows, false}, random);
    return mesh;
}

ClothMesh irregular_patch(int columns, int rows, double edge_length, Random& random) {
    ClothMesh mesh = flat_patch(columns, rows, edge_length, 0.2, random);
    for (int round = 0; round < 3; ++round) flip_some_edges(mesh, random);
    return mesh;
}

ClothMesh several_pieces(int vertices, double edge_length, Random& random) {
    const int pieces = random.integer(2, 4);
    const int side = std::max(2, static_cast<int>(std::sqrt(vertices / pieces)));
    const double step = 2 * side * edge_length;
    ClothMesh mesh;
    for (int p = 0; p < pieces; ++p)
        append(mesh,
               side >= 3 && random.chance(0.5) ? open_tube(side, side, edge_length, 0.2, random)
                                               : flat_patch(side, side, edge_length, 0.2, random),
               p * step);
    const int isolated = random.integer(0, 2);
    for (int p = 0; p < isolated; ++p) {
        ClothMesh point;
        point.rest_position.setZero(1, 3);
        append(mesh, point, (pieces + p) * step);
    }
    return mesh;
}

ClothMesh patch_with_fin(int columns, int rows, double edge_length, Random& random) {
    ClothMesh mesh = flat_patch(columns, rows, edge_length, 0.2, random);
    const int seam = columns / 2, height = std::max(1, columns / 2), base = columns * rows;
    Positions fin(height * rows, 3);
    for (int j = 0; j < rows; ++j)
        for (int k = 0; k < height; ++k)
            fin.row(j * height + k) = mesh.rest_position.row(j * columns + seam) +
                                      Eigen::RowVector3d(0, 0, (k + 1 + random.uniform(-0.2, 0.2)) * edge_length);
    // The fin as a grid of its own, its first column renamed to that of the seam.
    Triangles triangle = grid_triangles({height + 1, rows, false}, random);
    for (int& v : triangle.reshaped()) {
        const int i = v % (height + 1), j = v / (height + 1);
        v = i == 0 ? j * columns + seam : base + j * height + i - 1;
    }
    mesh.rest_position.conservativeResize(base + fin.rows(), 3);
    mesh.rest_position.bottomRows(fin.rows()) = fin;
    const Eigen::Index triangles = mesh.triangle.rows();
    mesh.triangle.conservativeResize(triangles + triangle.rows(), 3);
    mesh.triangle.bottomRows(triangle.rows()) = triangle;
    return mesh;
}

void renumber_vertices(ClothMesh& mesh, Random& random) {
    std::vector<int> place(mesh.vertex_count());
    std::iota(place.begin(), place.end(), 0);
    for (int v = mesh.vertex_count() - 1; v > 0; --v) std::swap(place[v], place[random.integer(0, v)]);
    Positions position(mesh.rest_position.rows(), 3);
    for (int v = 0; v < mesh.vertex_count(); ++v) position.row(place[v]) = mesh.rest_position.row(v);
    mesh.rest_position = position;
    for (int& v : mesh.triangle.reshaped()) v = place[v];
}

}  // namespace toile::evaluate
