#include "simulate/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <utility>
#include <vector>

namespace toile::simulate {

int count_self_intersections(const Triangles& triangle, const Positions& position) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    Mesh mesh;
    std::vector<Mesh::Vertex_index> vertex;
    for (int v = 0; v < position.rows(); ++v)
        vertex.push_back(mesh.add_vertex({position(v, 0), position(v, 1), position(v, 2)}));
    for (int f = 0; f < triangle.rows(); ++f)
        mesh.add_face(vertex[triangle(f, 0)], vertex[triangle(f, 1)], vertex[triangle(f, 2)]);
    std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
    CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs));
    return static_cast<int>(pairs.size());
}

}  // namespace toile::simulate
