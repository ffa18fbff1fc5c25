#include "cloth/topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace toile {
namespace {

/// One triangle's side: the edge opposite `corner`.
struct Side {
    int low, high, triangle, corner;
    bool operator<(const Side& other) const {
        return std::tie(low, high, triangle, corner) < std::tie(other.low, other.high, other.triangle, other.corner);
    }
};

std::vector<Side> sorted_sides(const Triangles& triangle) {
    std::vector<Side> sides;
    sides.reserve(3 * static_cast<size_t>(triangle.rows()));
    for (int f = 0; f < triangle.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const auto [low, high] = std::minmax(triangle(f, (corner + 1) % 3), triangle(f, (corner + 2) % 3));
            sides.push_back({low, high, f, corner});
        }
    }
    std::sort(sides.begin(), sides.end());
    return sides;
}

}  // namespace

Topology build_topology(const Triangles& triangle) {
    const std::vector<Side> sides = sorted_sides(triangle);
    Topology topology;
    topology.triangle_edge.resize(triangle.rows(), 3);
    std::vector<std::array<int, 4>> rows;  // low, high, first triangle, second triangle
    for (size_t i = 0; i < sides.size(); ++i) {
        const Side& side = sides[i];
        const bool starts_edge = i == 0 || side.low != sides[i - 1].low || side.high != sides[i - 1].high;
        if (starts_edge) {
            rows.push_back({side.low, side.high, side.triangle, -1});
        } else if (rows.back()[3] < 0) {
            rows.back()[3] = side.triangle;
        } else if (topology.non_manifold_edge < 0) {
            topology.non_manifold_edge = static_cast<int>(rows.size()) - 1;
        }
        topology.triangle_edge(side.triangle, side.corner) = static_cast<int>(rows.size()) - 1;
    }
    topology.edge.resize(static_cast<int>(rows.size()), 2);
    topology.edge_triangle.resize(static_cast<int>(rows.size()), 2);
    for (int e = 0; e < static_cast<int>(rows.size()); ++e) {
        topology.edge.row(e) << rows[e][0], rows[e][1];
        topology.edge_triangle.row(e) << rows[e][2], rows[e][3];
    }
    return topology;
}

std::vector<std::vector<int>> boundary_loops(const Triangles& triangle) {
    const Topology topology = build_topology(triangle);
    // A vertex where two boundaries touch has several ways on; each directed edge is used once.
    std::multimap<int, int> next;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        if (topology.edge_triangle(e, 1) >= 0) continue;
        const int f = topology.edge_triangle(e, 0);
        for (int corner = 0; corner < 3; ++corner) {
            const int from = triangle(f, corner), to = triangle(f, (corner + 1) % 3);
            if (std::min(from, to) == topology.edge(e, 0) && std::max(from, to) == topology.edge(e, 1))
                next.emplace(from, to);
        }
    }
    std::vector<std::vector<int>> loops;
    while (!next.empty()) {
        std::vector<int>& loop = loops.emplace_back();
        int at = next.begin()->first;
        for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
            loop.push_back(at);
            at = step->second;
            next.erase(step);
            if (at == loop.front()) break;
        }
    }
    return loops;
}

Eigen::Matrix<int, -1, 4, Eigen::RowMajor> build_hinges(const Topology& topology, const Triangles& triangle) {
    auto opposite = [&](int f, int a, int b) { return triangle.row(f).sum() - a - b; };
    std::vector<std::array<int, 4>> hinges;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const int f0 = topology.edge_triangle(e, 0), f1 = topology.edge_triangle(e, 1);
        if (f1 < 0) continue;
        const int a = topology.edge(e, 0), b = topology.edge(e, 1);
        hinges.push_back({a, b, opposite(f0, a, b), opposite(f1, a, b)});
    }
    Eigen::Matrix<int, -1, 4, Eigen::RowMajor> rows(static_cast<int>(hinges.size()), 4);
    for (size_t h = 0; h < hinges.size(); ++h) rows.row(h) << hinges[h][0], hinges[h][1], hinges[h][2], hinges[h][3];
    return rows;
}

std::vector<int> connected_components(const Triangles& triangle, int vertex_count) {
    std::vector<int> parent(static_cast<size_t>(vertex_count));
    std::iota(parent.begin(), parent.end(), 0);
    auto find = [&](int v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (int f = 0; f < triangle.rows(); ++f) {
        for (int corner = 1; corner < 3; ++corner) {
            const int first = find(triangle(f, 0)), other = find(triangle(f, corner));
            parent[std::max(first, other)] = std::min(first, other);
        }
    }
    std::vector<int> component(static_cast<size_t>(vertex_count));
    std::vector<int> number(static_cast<size_t>(vertex_count), -1);
    int count = 0;
    for (int v = 0; v < vertex_count; ++v) {
        const int root = find(v);
        if (number[root] < 0) number[root] = count++;
        component[v] = number[root];
    }
    return component;
}

Positions vertex_normals(const Triangles& triangle, const Positions& position) {
    Positions normal = Positions::Zero(position.rows(), 3);
    for (int f = 0; f < triangle.rows(); ++f) {
        const Eigen::RowVector3d p[3] = {position.row(triangle(f, 0)), position.row(triangle(f, 1)),
                                         position.row(triangle(f, 2))};
        const Eigen::RowVector3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
        const double twice_area = cross.norm();
        if (!(twice_area > 0.0)) continue;
        for (int corner = 0; corner < 3; ++corner) {
            const Eigen::RowVector3d u = p[(corner + 1) % 3] - p[corner], v = p[(corner + 2) % 3] - p[corner];
            normal.row(triangle(f, corner)) += std::atan2(twice_area, u.dot(v)) / twice_area * cross;
        }
    }
    for (int v = 0; v < normal.rows(); ++v) {
        const double length = normal.row(v).norm();
        if (length > 0.0) normal.row(v) /= length;
    }
    return normal;
}

}  // namespace toile
