#include "skin/hole_filling.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <algorithm>
#include <set>
#include <vector>

#include "cloth/topology.h"

namespace toile::skin {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Indices into a loop, as CGAL hands them out.
struct LoopTriangle {
    int a, b, c;
    LoopTriangle(int first, int second, int third) : a(first), b(second), c(third) {}
};

}  // namespace

FilledHoles fill_holes(const Triangles& triangle, const Positions& position) {
    FilledHoles out{triangle, 0, 0};
    std::vector<Eigen::RowVector3i> added;
    for (const std::vector<int>& loop : boundary_loops(triangle)) {
        std::vector<Kernel::Point_3> polyline;
        for (const int v : loop) polyline.emplace_back(position(v, 0), position(v, 1), position(v, 2));
        std::vector<LoopTriangle> patch;
        if (loop.size() >= 3 && std::set<int>(loop.begin(), loop.end()).size() == loop.size())
            CGAL::Polygon_mesh_processing::triangulate_hole_polyline(polyline, std::back_inserter(patch));
        if (patch.empty()) {
            ++out.open;
            continue;
        }
        ++out.filled;
        // Boundary edges run along the surface; the filling runs them backwards.
        for (const LoopTriangle& t : patch) {
            int corner[3] = {t.a, t.b, t.c};
            std::sort(corner, corner + 3);
            added.emplace_back(loop[corner[2]], loop[corner[1]], loop[corner[0]]);
        }
    }
    out.triangle.conservativeResize(triangle.rows() + static_cast<long>(added.size()), 3);
    for (size_t f = 0; f < added.size(); ++f) out.triangle.row(triangle.rows() + static_cast<long>(f)) = added[f];
    return out;
}

}  // namespace toile::skin
