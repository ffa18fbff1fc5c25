#include "simulate/sheet_gap.h"

#include <algorithm>

namespace toile::simulate {

SheetGap::SheetGap(const Triangles& triangle, const Edges& edge, const std::vector<bool>& free)
    : free_(free), candidates_(triangle, edge) {}

template <class Visit>
void SheetGap::each_near(const std::vector<bool>& marked, double radius, const Positions& x, Visit&& visit) {
    candidates_.find(x, radius, pairs_);
    const auto concerned = [&](const std::array<int, 4>& point) {
        return std::any_of(point.begin(), point.end(), [&](int v) { return marked[v]; });
    };
    for (const VertexTrianglePair& pair : pairs_.vertex_triangle)
        if (concerned(pair.point)) visit(pair.point, vertex_triangle_proximity);
    for (const EdgeEdgePair& pair : pairs_.edge_edge)
        if (concerned(pair.point)) visit(pair.point, edge_edge_proximity);
}

double SheetGap::smallest(const std::vector<bool>& marked, double radius, const Positions& x) {
    double smallest = radius;
    each_near(marked, radius, x, [&](const std::array<int, 4>& point, auto&& proximity) {
        smallest = std::min(smallest, proximity(gather(x, point)).distance());
    });
    return smallest;
}

void SheetGap::open(const std::vector<bool>& marked, double gap, double share, Positions& x) {
    each_near(marked, gap, x, [&](const std::array<int, 4>& point, auto&& proximity) {
        const Proximity near = proximity(gather(x, point));
        const double distance = near.distance();
        if (distance >= gap || !(distance > 0.0)) return;
        double mobility = 0.0;
        for (int k = 0; k < 4; ++k)
            if (free_[point[k]]) mobility += near.weight[k] * near.weight[k];
        if (!(mobility > 1e-3)) return;
        const Eigen::Vector3d by = share * (gap - distance) / (distance * mobility) * near.difference;
        for (int k = 0; k < 4; ++k)
            if (free_[point[k]]) x.row(point[k]) += near.weight[k] * by.transpose();
    });
}

}  // namespace toile::simulate
