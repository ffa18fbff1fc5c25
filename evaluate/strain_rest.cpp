#include "evaluate/strain_rest.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "cloth/error.h"
#include "cloth/topology.h"

namespace toile::evaluate {
namespace {

constexpr double smallest_height = 1e-10;  // of the longest edge
constexpr double flatness = 1e-9;          // distance from the plane, of the extent

void check_indices(const Triangles& triangle, Eigen::Index count, const std::string& where) {
    for (Eigen::Index f = 0; f < triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            if (triangle(f, corner) < 0 || triangle(f, corner) >= count)
                throw Error("triangle " + std::to_string(f) + " refers to vertex " +
                                std::to_string(triangle(f, corner)) + " of " + std::to_string(count),
                            where);
}

template <typename Rows>
void check_finite(const Rows& position, const std::string& where) {
    for (Eigen::Index v = 0; v < position.rows(); ++v)
        if (!position.row(v).allFinite())
            throw Error("vertex " + std::to_string(v) + " of the rest state is not finite", where);
}

void check_mesh(const ClothMesh& mesh, const std::string& where) {
    if (mesh.triangle_count() == 0) throw Error("the rest state has no triangles", where);
    check_indices(mesh.triangle, mesh.vertex_count(), where);
    check_finite(mesh.rest_position, where);
    if (mesh.pattern_triangle.rows() == 0) return;
    check_indices(mesh.pattern_triangle, mesh.pattern_position.rows(), where);
    check_finite(mesh.pattern_position, where);
}

StrainRest::Triangle rest_triangle(const StrainRest& rest, Eigen::Index f) {
    const Eigen::Vector3d origin = rest.point.row(rest.triangle(f, 0));
    const Eigen::Vector3d second = rest.point.row(rest.triangle(f, 1)), third = rest.point.row(rest.triangle(f, 2));
    StrainRest::Triangle out;
    out.axis.setZero();
    out.inverse_edge.setZero();
    if (is_degenerate(origin, second, third)) {
        out.fault = StrainFault::degenerate_rest;
        return out;
    }
    Eigen::Matrix<double, 3, 2> edge;
    edge << second - origin, third - origin;
    if (rest.from_pattern) {
        out.axis << 1, 0, 0, 1, 0, 0;
    } else {
        out.axis.col(0) = edge.col(0).normalized();
        out.axis.col(1) = edge.col(0).cross(edge.col(1)).normalized().cross(out.axis.col(0));
    }
    out.inverse_edge = (out.axis.transpose() * edge).inverse();
    if (!out.inverse_edge.allFinite() || !out.axis.allFinite()) out.fault = StrainFault::overflow;
    return out;
}

}  // namespace

const char* strain_fault_name(StrainFault fault) {
    static constexpr std::array<const char*, strain_fault_count> name = {
        "none", "degenerate rest", "collapsed", "inverted", "too few vertices", "low rank", "no normal", "overflow"};
    return name.at(static_cast<size_t>(fault));
}

bool is_degenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double size =
        std::max({a.lpNorm<Eigen::Infinity>(), b.lpNorm<Eigen::Infinity>(), c.lpNorm<Eigen::Infinity>()});
    const double resolved = 16 * std::numeric_limits<double>::epsilon() * size;
    if (!(longest > 0)) return true;
    const double height = ((b - a) / longest).cross(c - a).norm();
    return height <= std::max(smallest_height * longest, resolved);
}

std::vector<double> flat_orientation(const Triangles& triangle, const Positions& position) {
    const Eigen::RowVector3d centre = position.colwise().mean();
    const Positions about = position.rowwise() - centre;
    const double extent = about.rowwise().norm().maxCoeff();
    Eigen::Matrix3d spread = (about / extent).transpose() * (about / extent);
    if (!(extent > 0) || !spread.allFinite()) return {};
    const Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
    if ((about * normal).cwiseAbs().maxCoeff() > flatness * extent) return {};
    std::vector<double> area(static_cast<size_t>(triangle.rows()), 0.0);
    double sum = 0, total = 0;
    for (Eigen::Index f = 0; f < triangle.rows(); ++f) {
        const Eigen::Vector3d a = position.row(triangle(f, 0)), b = position.row(triangle(f, 1)),
                              c = position.row(triangle(f, 2));
        if (is_degenerate(a, b, c)) continue;
        area[f] = (b - a).cross(c - a).dot(normal);
        sum += area[f];
        total += std::abs(area[f]);
    }
    if (!(std::abs(sum) > flatness * total)) return {};
    for (double& one : area) one = one == 0 ? 0 : (one > 0) == (sum > 0) ? 1 : -1;
    return area;
}

Positions point_positions(const StrainRest& rest, const Positions& position) {
    Positions out(rest.point.rows(), 3);
    for (Eigen::Index p = 0; p < out.rows(); ++p) {
        if (rest.vertex[p] < 0)
            out.row(p).setZero();
        else
            out.row(p) = position.row(rest.vertex[p]);
    }
    return out;
}

StrainRest strain_rest(const ClothMesh& mesh, const std::string& where) {
    check_mesh(mesh, where);
    StrainRest rest;
    rest.from_pattern = mesh.pattern_triangle.rows() > 0;
    rest.vertex_count = mesh.vertex_count();
    rest.mesh_triangle = mesh.triangle;
    rest.triangle = rest.from_pattern ? mesh.pattern_triangle : mesh.triangle;
    if (rest.from_pattern) {
        rest.point = Positions::Zero(mesh.pattern_position.rows(), 3);
        rest.point.leftCols<2>() = mesh.pattern_position;
    } else {
        rest.point = mesh.rest_position;
    }
    rest.vertex.assign(static_cast<size_t>(rest.point.rows()), -1);
    for (Eigen::Index f = 0; f < rest.triangle.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) rest.vertex[rest.triangle(f, corner)] = mesh.triangle(f, corner);
    rest.normal = vertex_normals(rest.triangle, rest.point);
    for (Eigen::Index f = 0; f < rest.triangle.rows(); ++f) rest.frame.push_back(rest_triangle(rest, f));
    rest.orientation = flat_orientation(mesh.triangle, mesh.rest_position);
    return rest;
}

}  // namespace toile::evaluate
