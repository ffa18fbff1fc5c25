#include "prior/rest_state.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "cloth/error.h"

namespace toile::prior {
namespace {

/// Triangles at one edge; pairs of them grow with its square, so that a broken file could ask for all memory.
constexpr size_t most_triangles_at_an_edge = 100;

[[noreturn]] void fail(const std::string& what, const std::string& where) {
    throw Error(what, where);
}

std::string edge_name(const Edges& edge, Eigen::Index e) {
    return "edge (" + std::to_string(edge(e, 0)) + ", " + std::to_string(edge(e, 1)) + ")";
}

bool has_pattern(const ClothMesh& mesh) {
    return mesh.pattern_position.rows() > 0 || mesh.pattern_triangle.rows() > 0;
}

template <typename Rows>
void check_finite(const Rows& rows, const char* kind, const std::string& where) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
        if (!rows.row(i).allFinite()) fail(std::string(kind) + " " + std::to_string(i) + " is not finite", where);
}

void check_indices(const Triangles& triangle, Eigen::Index count, const char* kind, const std::string& where) {
    for (Eigen::Index f = 0; f < triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int v = triangle(f, corner);
            if (v < 0 || v >= count)
                fail("triangle " + std::to_string(f) + " refers to " + kind + " " + std::to_string(v) + " of " +
                         std::to_string(count),
                     where);
        }
}

void check_mesh(const ClothMesh& mesh, const std::string& where) {
    if (mesh.vertex_count() == 0) fail("the mesh has no vertices", where);
    check_finite(mesh.rest_position, "vertex", where);
    check_indices(mesh.triangle, mesh.rest_position.rows(), "vertex", where);
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f) {
        const auto t = mesh.triangle.row(f);
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            fail("triangle " + std::to_string(f) + " uses one vertex twice", where);
    }
    if (!has_pattern(mesh)) return;
    if (mesh.pattern_triangle.rows() != mesh.triangle.rows())
        fail("the mesh has " + std::to_string(mesh.triangle.rows()) + " triangles but " +
                 std::to_string(mesh.pattern_triangle.rows()) + " pattern triangles",
             where);
    check_finite(mesh.pattern_position, "pattern position", where);
    check_indices(mesh.pattern_triangle, mesh.pattern_position.rows(), "pattern position", where);
}

/// Where the corners of triangle f rest: in the pattern if there is one.
std::array<Eigen::Vector3d, 3> rest_corners(const ClothMesh& mesh, Eigen::Index f) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int i = 0; i < 3; ++i) {
        if (has_pattern(mesh))
            corner[i] << mesh.pattern_position.row(mesh.pattern_triangle(f, i)).transpose(), 0.0;
        else
            corner[i] = mesh.rest_position.row(mesh.triangle(f, i)).transpose();
    }
    return corner;
}

Eigen::VectorXd edge_rest_lengths(const ClothMesh& mesh, const Topology& topology, const std::string& where) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(topology.edge.rows()), count = sum;
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f) {
        const auto rest = rest_corners(mesh, f);
        for (int corner = 0; corner < 3; ++corner) {
            const int e = topology.triangle_edge(f, corner);
            sum[e] += (rest[(corner + 1) % 3] - rest[(corner + 2) % 3]).norm();
            count[e] += 1;
        }
    }
    for (Eigen::Index e = 0; e < sum.size(); ++e) {
        sum[e] /= count[e];
        if (sum[e] == 0) fail(edge_name(topology.edge, e) + " has no length at rest", where);
        if (!std::isfinite(sum[e])) fail(edge_name(topology.edge, e) + " is too long for a number", where);
    }
    return sum;
}

/// Mass of a unit of density per area; zero at a vertex without triangles, and next to zero if they have no area.
Eigen::VectorXd uniform_mass(const ClothMesh& mesh) {
    Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.vertex_count());
    for (Eigen::Index f = 0; f < mesh.triangle.rows(); ++f) {
        const auto rest = rest_corners(mesh, f);
        const double area = 0.5 * (rest[1] - rest[0]).cross(rest[2] - rest[0]).norm();
        for (int corner = 0; corner < 3; ++corner) mass[mesh.triangle(f, corner)] += area / 3;
    }
    return mass;
}

void check_mass(const ClothMesh& mesh, const std::string& where) {
    if (mesh.mass.size() != mesh.vertex_count())
        fail("the mesh has " + std::to_string(mesh.vertex_count()) + " vertices but " +
                 std::to_string(mesh.mass.size()) + " masses",
             where);
    std::vector<char> used(static_cast<size_t>(mesh.vertex_count()), 0);
    for (const int v : mesh.triangle.reshaped()) used[v] = 1;
    for (Eigen::Index v = 0; v < mesh.mass.size(); ++v) {
        const double mass = mesh.mass[v];
        const char* fault = !std::isfinite(mass)   ? "is not finite"
                            : mass < 0             ? "is negative"
                            : mass == 0 && used[v] ? "is zero"
                                                   : nullptr;
        if (fault) fail("the mass of vertex " + std::to_string(v) + " " + fault, where);
    }
}

Eigen::VectorXd positive_mass(const ClothMesh& mesh, const std::string& where) {
    const bool given = mesh.mass.size() > 0;
    if (given) check_mass(mesh, where);
    Eigen::VectorXd mass = given ? mesh.mass : uniform_mass(mesh);
    const double carriers = static_cast<double>((mass.array() > 0).count());
    const double mean = carriers > 0 ? (mass / carriers).sum() : 1.0;
    if (!std::isfinite(mean)) fail("the mesh is too large for a number", where);
    // A given mass may be as small as it likes; one that comes from triangles without area is rounding.
    const double least = given ? 0.0 : 1e-9 * mean;
    return (mass.array() > least).select(mass, mean);
}

/// A triangle's third vertex beside the side a-b of length `base`: how far along a-b, and how far from that line.
Eigen::Vector2d third_vertex(double base, double from_a, double from_b) {
    // Kahan's form of Heron's formula keeps the height of a thin triangle accurate.
    std::array<double, 3> l{base, from_a, from_b};
    std::sort(l.begin(), l.end(), std::greater<>());
    const double thin = std::max((l[2] - (l[0] - l[1])) * (l[2] + (l[0] - l[1])), 0.0);  // 0: no such triangle
    const double wide = (l[0] + (l[1] + l[2])) * (l[0] + (l[1] - l[2]));
    const double height = std::sqrt(thin) * std::sqrt(wide) / (2 * base);
    const double along = 0.5 * (base + (from_a - from_b) * (from_a + from_b) / base);
    return {along, height};
}

struct Sides {
    double base, from_a, from_b;  ///< rest lengths of a-b and of the sides that meet at the opposite vertex
    int opposite;
};

Sides sides_of(const ClothMesh& mesh, const Topology& topology, const Eigen::VectorXd& rest_length, int f, int e) {
    Sides sides{rest_length[e], 0, 0, -1};
    for (int corner = 0; corner < 3; ++corner) {
        const int side = topology.triangle_edge(f, corner), v = mesh.triangle(f, corner);
        if (side == e) sides.opposite = v;
        // the side opposite to b joins a and the third vertex
        if (side != e && v == topology.edge(e, 1)) sides.from_a = rest_length[side];
        if (side != e && v == topology.edge(e, 0)) sides.from_b = rest_length[side];
    }
    return sides;
}

std::vector<std::vector<int>> triangles_by_edge(const Topology& topology, const std::string& where) {
    std::vector<std::vector<int>> at(static_cast<size_t>(topology.edge.rows()));
    for (int f = 0; f < topology.triangle_edge.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) at[topology.triangle_edge(f, corner)].push_back(f);
    for (size_t e = 0; e < at.size(); ++e)
        if (at[e].size() > most_triangles_at_an_edge)
            fail(edge_name(topology.edge, static_cast<Eigen::Index>(e)) + " belongs to " +
                     std::to_string(at[e].size()) + " triangles, more than " +
                     std::to_string(most_triangles_at_an_edge),
                 where);
    return at;
}

void add_hinges(const ClothMesh& mesh, const Topology& topology, const std::string& where, RestState& rest) {
    const auto triangles = triangles_by_edge(topology, where);
    std::vector<std::array<int, 4>> hinge;
    std::vector<std::array<double, 3>> flat;  // distance of c and d, u, v
    for (int e = 0; e < topology.edge.rows(); ++e) {
        for (size_t i = 0; i < triangles[e].size(); ++i) {
            for (size_t j = i + 1; j < triangles[e].size(); ++j) {
                const Sides first = sides_of(mesh, topology, rest.edge_rest_length, triangles[e][i], e);
                const Sides second = sides_of(mesh, topology, rest.edge_rest_length, triangles[e][j], e);
                if (first.opposite == second.opposite) continue;
                const Eigen::Vector2d c = third_vertex(first.base, first.from_a, first.from_b);
                const Eigen::Vector2d d = third_vertex(second.base, second.from_a, second.from_b);
                const double height = c.y() + d.y();
                const double v = height > 0 ? c.y() / height : 0.5;
                const double u = ((1 - v) * c.x() + v * d.x()) / first.base;
                hinge.push_back({topology.edge(e, 0), topology.edge(e, 1), first.opposite, second.opposite});
                flat.push_back({std::hypot(c.x() - d.x(), height), u, v});
            }
        }
    }
    const auto count = static_cast<Eigen::Index>(hinge.size());
    rest.hinge.resize(count, 4);
    rest.hinge_rest_length.resize(count);
    rest.hinge_crossing.resize(count, 2);
    for (Eigen::Index h = 0; h < count; ++h) {
        rest.hinge.row(h) = Eigen::Map<const Eigen::RowVector4i>(hinge[h].data());
        rest.hinge_rest_length[h] = flat[h][0];
        rest.hinge_crossing.row(h) << flat[h][1], flat[h][2];
    }
}

}  // namespace

RestState rest_state(const ClothMesh& mesh, const std::string& where) {
    check_mesh(mesh, where);
    const Topology topology = build_topology(mesh.triangle);
    RestState rest;
    rest.vertex_count = mesh.vertex_count();
    rest.edge = topology.edge;
    rest.edge_rest_length = edge_rest_lengths(mesh, topology, where);
    rest.mass = positive_mass(mesh, where);
    add_hinges(mesh, topology, where, rest);
    return rest;
}

}  // namespace toile::prior
