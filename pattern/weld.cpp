#include "pattern/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace toile::pattern {
namespace {

using Cell = std::array<long long, 3>;

int find(std::vector<int>& parent, int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

void join(std::vector<int>& parent, int a, int b) {
    a = find(parent, a);
    b = find(parent, b);
    parent[std::max(a, b)] = std::min(a, b);
}

/// Joins rows nearer than the tolerance, found through the 27 cells around each.
void join_near(const Positions& position, double tolerance, std::vector<int>& parent) {
    const Eigen::RowVector3d lower = position.colwise().minCoeff();
    auto cell_of = [&](int v) {
        Cell cell;
        for (int k = 0; k < 3; ++k)
            cell[k] = static_cast<long long>(std::floor((position(v, k) - lower[k]) / tolerance));
        return cell;
    };
    std::map<Cell, std::vector<int>> cells;
    for (int v = 0; v < position.rows(); ++v)
        if (parent[v] == v) cells[cell_of(v)].push_back(v);
    for (const auto& [cell, rows] : cells) {
        for (int step = 0; step < 27; ++step) {
            const auto near = cells.find({cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1, cell[2] + step / 9 - 1});
            if (near == cells.end()) continue;
            for (int a : rows)
                for (int b : near->second)
                    if (a < b && (position.row(a) - position.row(b)).norm() <= tolerance) join(parent, a, b);
        }
    }
}

}  // namespace

std::vector<int> weld_positions(const Positions& position, double tolerance, int& vertex_count) {
    const int rows = static_cast<int>(position.rows());
    std::vector<int> parent(static_cast<size_t>(rows));
    std::iota(parent.begin(), parent.end(), 0);
    std::map<std::array<double, 3>, int> first;
    for (int v = 0; v < rows; ++v)
        join(parent, v, first.try_emplace({position(v, 0), position(v, 1), position(v, 2)}, v).first->second);
    if (rows > 0 && tolerance > 0.0) join_near(position, tolerance, parent);
    std::vector<int> vertex(static_cast<size_t>(rows));
    vertex_count = 0;
    for (int v = 0; v < rows; ++v) {
        const int root = find(parent, v);
        vertex[v] = root == v ? vertex_count++ : vertex[root];
    }
    return vertex;
}

double median_edge(const Triangles& triangle, const Positions& position) {
    std::vector<double> length;
    for (int f = 0; f < triangle.rows(); ++f)
        for (int k = 0; k < 3; ++k)
            length.push_back((position.row(triangle(f, k)) - position.row(triangle(f, (k + 1) % 3))).norm());
    if (length.empty()) return 0.0;
    std::nth_element(length.begin(), length.begin() + static_cast<std::ptrdiff_t>(length.size() / 2), length.end());
    return length[length.size() / 2];
}

}  // namespace toile::pattern
