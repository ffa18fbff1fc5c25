#include "skin/surface_relaxation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "cloth/topology.h"

namespace toile::skin {
namespace {

using Distance = std::function<double(const Eigen::Vector3d&)>;

Eigen::Vector3d at(const Surface& surface, int vertex) {
    return surface.position.row(vertex);
}

Eigen::Vector3d normal(const Surface& surface, int a, int b, int c) {
    return (at(surface, b) - at(surface, a)).cross(at(surface, c) - at(surface, a));
}

/// One Newton step onto the zero of `distance` along `normal`, no longer than `limit`.
Eigen::Vector3d pulled_to_zero(const Distance& distance, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                               double limit) {
    const double step = 1e-4, value = distance(point);
    const double slope = (distance(point + step * normal) - value) / step;
    const double move = std::abs(slope) > 0.2 ? -value / slope : 0.0;
    return point + std::clamp(move, -limit, limit) * normal;
}

void move_to_neighbours_mean(const Distance& distance, const Topology& topology, Surface& surface) {
    Positions sum = Positions::Zero(surface.position.rows(), 3);
    Eigen::VectorXi count = Eigen::VectorXi::Zero(surface.position.rows());
    for (Eigen::Index e = 0; e < topology.edge.rows(); ++e)
        for (int end = 0; end < 2; ++end) {
            sum.row(topology.edge(e, end)) += surface.position.row(topology.edge(e, 1 - end));
            ++count[topology.edge(e, end)];
        }
    const Positions normals = vertex_normals(surface.triangle, surface.position);
    for (Eigen::Index v = 0; v < surface.position.rows(); ++v) {
        const Eigen::Vector3d n = normals.row(v), mean = sum.row(v) / count[v], now = surface.position.row(v);
        const Eigen::Vector3d move = 0.6 * (mean - now);
        const Eigen::Vector3d along = move - n * n.dot(move);
        surface.position.row(v) = pulled_to_zero(distance, now + along, n, 0.5 * (mean - now).norm() + 1e-3);
    }
}

double angle_at(const Surface& surface, int corner, int a, int b) {
    const Eigen::Vector3d u = at(surface, a) - at(surface, corner), v = at(surface, b) - at(surface, corner);
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// The vertices that share an edge with each vertex, as they change with the flips.
class Neighbours {
  public:
    Neighbours(const Topology& topology, Eigen::Index vertex_count) : of_(static_cast<size_t>(vertex_count)) {
        for (Eigen::Index e = 0; e < topology.edge.rows(); ++e) join(topology.edge(e, 0), topology.edge(e, 1));
    }
    bool joined(int a, int b) const { return std::find(of_[a].begin(), of_[a].end(), b) != of_[a].end(); }
    size_t valence(int vertex) const { return of_[vertex].size(); }
    void join(int a, int b) {
        of_[a].push_back(b);
        of_[b].push_back(a);
    }
    void part(int a, int b) {
        std::erase(of_[a], b);
        std::erase(of_[b], a);
    }

  private:
    std::vector<std::vector<int>> of_;
};

/// Flips the edge (a, b) between two triangles where that is Delaunay, keeps the surface manifold and does not fold it.
bool flip(int first, int second, int a, int b, Neighbours& neighbours, Surface& surface) {
    const auto opposite = [&](int triangle) {
        int corner = 0;
        while (surface.triangle(triangle, corner) == a || surface.triangle(triangle, corner) == b) ++corner;
        return corner;
    };
    const int corner = opposite(first);
    const int c = surface.triangle(first, corner), d = surface.triangle(second, opposite(second));
    const int from = surface.triangle(first, (corner + 1) % 3), to = surface.triangle(first, (corner + 2) % 3);
    if (angle_at(surface, c, a, b) + angle_at(surface, d, a, b) <= M_PI + 1e-6) return false;
    if (neighbours.joined(c, d) || neighbours.valence(a) <= 4 || neighbours.valence(b) <= 4) return false;
    const Eigen::Vector3d before = normal(surface, c, from, to) + normal(surface, from, d, to);
    const Eigen::Vector3d one = normal(surface, c, from, d), other = normal(surface, c, d, to);
    if (one.dot(before) <= 0.8 * one.norm() * before.norm() || other.dot(before) <= 0.8 * other.norm() * before.norm())
        return false;
    surface.triangle.row(first) << c, from, d;
    surface.triangle.row(second) << c, d, to;
    neighbours.part(a, b);
    neighbours.join(c, d);
    return true;
}

/// One pass over the edges; edges of triangles that have already changed in it wait for the next round.
void flip_to_delaunay(const Topology& topology, Surface& surface) {
    Neighbours neighbours(topology, surface.position.rows());
    std::vector<char> changed(static_cast<size_t>(surface.triangle.rows()), 0);
    for (Eigen::Index e = 0; e < topology.edge.rows(); ++e) {
        const int first = topology.edge_triangle(e, 0), second = topology.edge_triangle(e, 1);
        if (second < 0 || changed[first] || changed[second]) continue;
        if (flip(first, second, topology.edge(e, 0), topology.edge(e, 1), neighbours, surface))
            changed[first] = changed[second] = 1;
    }
}

}  // namespace

void relax_surface(const Distance& distance, int rounds, Surface& surface) {
    for (int round = 0; round < rounds; ++round) {
        const Topology topology = build_topology(surface.triangle);
        move_to_neighbours_mean(distance, topology, surface);
        flip_to_delaunay(topology, surface);
    }
}

}  // namespace toile::skin
