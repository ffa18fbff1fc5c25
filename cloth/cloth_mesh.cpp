#include "cloth/cloth_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile {
namespace {

std::string numbered(const char* what, long index) {
    return std::string(what) + " " + std::to_string(index);
}

void check_indices(const Triangles& triangle, long count, const char* kind, const std::string& where) {
    for (int f = 0; f < triangle.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner) {
            const int v = triangle(f, corner);
            if (v < 0 || v >= count)
                throw Error(numbered("triangle", f) + " refers to " + kind + " " + std::to_string(v) + " of " +
                                std::to_string(count),
                            where);
        }
        if (triangle(f, 0) == triangle(f, 1) || triangle(f, 1) == triangle(f, 2) || triangle(f, 2) == triangle(f, 0))
            throw Error(numbered("triangle", f) + " uses one " + kind + " twice", where);
    }
}

template <typename Rows>
void check_finite(const Rows& rows, const char* kind, const std::string& where) {
    for (int v = 0; v < rows.rows(); ++v)
        if (!rows.row(v).allFinite()) throw Error(numbered(kind, v) + " is not finite", where);
}

void check_areas(const ClothMesh& mesh, const std::string& where) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto t = mesh.triangle.row(f);
        const auto p = mesh.pattern_triangle.row(f);
        const Eigen::RowVector3d a = mesh.rest_position.row(t[1]) - mesh.rest_position.row(t[0]);
        const Eigen::RowVector3d b = mesh.rest_position.row(t[2]) - mesh.rest_position.row(t[0]);
        const Eigen::RowVector2d u = mesh.pattern_position.row(p[1]) - mesh.pattern_position.row(p[0]);
        const Eigen::RowVector2d v = mesh.pattern_position.row(p[2]) - mesh.pattern_position.row(p[0]);
        // Relative to the sides, so that the unit of the file does not matter.
        if (!(a.cross(b).norm() > 1e-7 * (a.squaredNorm() + b.squaredNorm())))
            throw Error(numbered("triangle", f) + " has no area", where);
        if (!(std::abs(u.x() * v.y() - u.y() * v.x()) > 1e-7 * (u.squaredNorm() + v.squaredNorm())))
            throw Error(numbered("triangle", f) + " has no area in the pattern", where);
    }
}

void check_connectivity(const ClothMesh& mesh, const std::string& where) {
    std::vector<bool> used(static_cast<size_t>(mesh.vertex_count()), false);
    for (int f = 0; f < mesh.triangle_count(); ++f)
        for (int corner = 0; corner < 3; ++corner) used[mesh.triangle(f, corner)] = true;
    for (int v = 0; v < mesh.vertex_count(); ++v)
        if (!used[v]) throw Error(numbered("vertex", v) + " belongs to no triangle", where);
    const Topology topology = build_topology(mesh.triangle);
    auto edge_name = [&](int e) {
        return "edge (" + std::to_string(topology.edge(e, 0)) + ", " + std::to_string(topology.edge(e, 1)) + ")";
    };
    if (topology.non_manifold_edge >= 0)
        throw Error(edge_name(topology.non_manifold_edge) + " belongs to more than two triangles", where);
    for (int e = 0; e < topology.edge.rows(); ++e) {
        if (topology.edge_triangle(e, 1) < 0) continue;
        int forward = 0;
        for (int side = 0; side < 2; ++side) {
            const auto t = mesh.triangle.row(topology.edge_triangle(e, side));
            for (int corner = 0; corner < 3; ++corner)
                forward += t[corner] == topology.edge(e, 0) && t[(corner + 1) % 3] == topology.edge(e, 1);
        }
        if (forward != 1) throw Error("the triangles at " + edge_name(e) + " are wound against each other", where);
    }
}

}  // namespace

Eigen::VectorXd lumped_mass(const ClothMesh& mesh, double density_per_area) {
    Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.vertex_count());
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto p = mesh.pattern_triangle.row(f);
        const Eigen::RowVector2d u = mesh.pattern_position.row(p[1]) - mesh.pattern_position.row(p[0]);
        const Eigen::RowVector2d v = mesh.pattern_position.row(p[2]) - mesh.pattern_position.row(p[0]);
        const double area = 0.5 * std::abs(u.x() * v.y() - u.y() * v.x());
        for (int corner = 0; corner < 3; ++corner) mass[mesh.triangle(f, corner)] += density_per_area * area / 3.0;
    }
    return mass;
}

void check_cloth_mesh(const ClothMesh& mesh, const std::string& where) {
    if (mesh.triangle_count() == 0) throw Error("the mesh has no triangles", where);
    if (mesh.pattern_triangle.rows() != mesh.triangle.rows())
        throw Error("the mesh has " + std::to_string(mesh.triangle.rows()) + " triangles but " +
                        std::to_string(mesh.pattern_triangle.rows()) + " pattern triangles",
                    where);
    check_finite(mesh.rest_position, "vertex", where);
    check_finite(mesh.pattern_position, "pattern position", where);
    check_indices(mesh.triangle, mesh.rest_position.rows(), "vertex", where);
    check_indices(mesh.pattern_triangle, mesh.pattern_position.rows(), "pattern position", where);
    check_connectivity(mesh, where);
    check_areas(mesh, where);
}

}  // namespace toile
