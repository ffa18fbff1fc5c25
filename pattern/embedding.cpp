#include "pattern/embedding.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "cloth/error.h"
#include "cloth/topology.h"
#include "skin/surface_query.h"

namespace toile::pattern {
namespace {

constexpr double smoothing_radius = 0.04;  // [m]

/// The value at a point of a triangle from those at its corners.
Eigen::RowVector3d interpolate(const Positions& at_vertex, const Triangles& triangle, int f,
                               const Eigen::RowVector3d& barycentric) {
    Eigen::RowVector3d value = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) value += barycentric[k] * at_vertex.row(triangle(f, k));
    return value;
}

/// The direction of the pattern's u axis in space: first column of the deformation gradient, unit; zero where the
/// pattern triangle has no area.
Eigen::RowVector3d u_axis(const ClothMesh& mesh, int f, double& pattern_area) {
    const auto t = mesh.triangle.row(f);
    const auto p = mesh.pattern_triangle.row(f);
    const Eigen::RowVector2d a = mesh.pattern_position.row(p[1]) - mesh.pattern_position.row(p[0]);
    const Eigen::RowVector2d b = mesh.pattern_position.row(p[2]) - mesh.pattern_position.row(p[0]);
    const Eigen::RowVector3d x = mesh.rest_position.row(t[1]) - mesh.rest_position.row(t[0]);
    const Eigen::RowVector3d y = mesh.rest_position.row(t[2]) - mesh.rest_position.row(t[0]);
    const double twice_area = a.x() * b.y() - a.y() * b.x();
    pattern_area = 0.5 * std::abs(twice_area);
    if (twice_area == 0.0) return Eigen::RowVector3d::Zero();
    const Eigen::RowVector3d axis = (b.y() * x - a.y() * y) / twice_area;
    return axis.norm() > 0.0 ? Eigen::RowVector3d(axis.normalized()) : axis;
}

/// The u axis at each vertex `[V x 3]`, the mean over its triangles by area, shorter than one where they disagree.
Positions vertex_u_axes(const ClothMesh& mesh) {
    const std::vector<int> panel =
        connected_components(mesh.pattern_triangle, static_cast<int>(mesh.pattern_position.rows()));
    Positions axis = Positions::Zero(mesh.vertex_count(), 3), first_axis = axis;
    Eigen::VectorXd area = Eigen::VectorXd::Zero(mesh.vertex_count()), first_area = area;
    std::vector<int> first_panel(static_cast<size_t>(mesh.vertex_count()), -1);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            int& first = first_panel[mesh.triangle(f, k)];
            const int here = panel[mesh.pattern_triangle(f, k)];
            if (first < 0 || here < first) first = here;
        }
    }
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        double weight = 0.0;
        const Eigen::RowVector3d direction = u_axis(mesh, f, weight);
        for (int k = 0; k < 3; ++k) {
            const int v = mesh.triangle(f, k);
            axis.row(v) += weight * direction;
            area[v] += weight;
            if (panel[mesh.pattern_triangle(f, k)] != first_panel[v]) continue;
            first_axis.row(v) += weight * direction;
            first_area[v] += weight;
        }
    }
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const bool agree = axis.row(v).norm() > 0.7 * area[v];
        const double weight = agree ? area[v] : first_area[v];
        if (!agree) axis.row(v) = first_axis.row(v);
        if (weight > 0.0) axis.row(v) /= weight;
    }
    return axis;
}

/// Each row becomes the mean of itself and its neighbours'.
Positions averaged(const Positions& value, const Edges& edge) {
    Positions sum = value;
    Eigen::VectorXd count = Eigen::VectorXd::Ones(value.rows());
    for (int e = 0; e < edge.rows(); ++e) {
        sum.row(edge(e, 0)) += value.row(edge(e, 1));
        sum.row(edge(e, 1)) += value.row(edge(e, 0));
        count[edge(e, 0)] += 1.0;
        count[edge(e, 1)] += 1.0;
    }
    return count.cwiseInverse().asDiagonal() * sum;
}

/// Rounds of averaging that spread a value over the smoothing radius: each widens it by about half an edge squared.
int smoothing_rounds(const Edges& edge, const Positions& position) {
    double mean_square = 0.0;
    for (int e = 0; e < edge.rows(); ++e)
        mean_square += (position.row(edge(e, 0)) - position.row(edge(e, 1))).squaredNorm() / edge.rows();
    if (!(mean_square > 0.0)) return 0;
    return std::clamp(static_cast<int>(std::lround(2.0 * smoothing_radius * smoothing_radius / mean_square)), 2, 60);
}

/// Averages quaternions with their neighbours', those of the other sign turned round first: a quaternion and its
/// negative are one rotation, and which of the two it is does not change when all are multiplied from the left.
void average(std::vector<Eigen::Quaterniond>& rotation, const Edges& edge) {
    std::vector<Eigen::Vector4d> sum(rotation.size());
    for (size_t v = 0; v < rotation.size(); ++v) sum[v] = rotation[v].coeffs();
    for (int e = 0; e < edge.rows(); ++e) {
        const int a = edge(e, 0), b = edge(e, 1);
        const double sign = rotation[a].dot(rotation[b]) < 0.0 ? -1.0 : 1.0;
        sum[a] += sign * rotation[b].coeffs();
        sum[b] += sign * rotation[a].coeffs();
    }
    for (size_t v = 0; v < rotation.size(); ++v)
        if (sum[v].norm() > 1e-9) rotation[v].coeffs() = sum[v].normalized();
}

std::vector<Eigen::Quaterniond> parent_rotations(const Embedding& embedding, const skin::Body& body,
                                                 const skin::Pose& pose) {
    const std::vector<Eigen::Quaterniond> blended = skin::blended_rotations(body, pose);
    std::vector<Eigen::Quaterniond> rotation(embedding.triangle.size());
    for (size_t v = 0; v < rotation.size(); ++v) {
        const auto corner = body.triangle.row(embedding.triangle[v]);
        const Eigen::RowVector3d weight = embedding.barycentric.row(static_cast<int>(v));
        int heaviest = 0;
        weight.maxCoeff(&heaviest);
        const Eigen::Quaterniond& reference = blended[corner[heaviest]];
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int k = 0; k < 3; ++k) {
            const Eigen::Quaterniond& one = blended[corner[k]];
            sum += (one.dot(reference) < 0.0 ? -weight[k] : weight[k]) * one.coeffs();
        }
        rotation[v].coeffs() = sum.normalized();
    }
    return rotation;
}

/// Smooths normals and tangents over the cloth and makes them unit and perpendicular.
void finish_frames(Embedding& embedding) {
    const Positions first_normal = embedding.normal;
    for (int round = 0; round < embedding.smoothing; ++round) {
        embedding.normal = averaged(embedding.normal, embedding.edge);
        embedding.tangent = averaged(embedding.tangent, embedding.edge);
    }
    for (int v = 0; v < embedding.normal.rows(); ++v) {
        Eigen::Vector3d normal = embedding.normal.row(v);
        if (normal.norm() < 1e-6) normal = first_normal.row(v);
        if (normal.norm() < 1e-6) normal = Eigen::Vector3d::UnitY();
        normal.normalize();
        Eigen::Vector3d tangent = embedding.tangent.row(v).transpose();
        tangent -= tangent.dot(normal) * normal;
        if (tangent.norm() < 1e-6) tangent = normal.unitOrthogonal();
        embedding.normal.row(v) = normal;
        embedding.tangent.row(v) = tangent.normalized();
    }
}

}  // namespace

Embedding embed(const ClothMesh& neutral_drape, const skin::Body& body) {
    const int vertices = neutral_drape.vertex_count();
    const skin::SurfaceQuery query(body.triangle, body.rest_position);
    const Positions body_normal = vertex_normals(body.triangle, body.rest_position);
    Embedding embedding;
    embedding.triangle.resize(static_cast<size_t>(vertices));
    embedding.barycentric.resize(vertices, 3);
    embedding.normal.resize(vertices, 3);
    for (int v = 0; v < vertices; ++v) {
        const auto nearest = query.nearest(neutral_drape.rest_position.row(v));
        embedding.triangle[v] = nearest.triangle;
        embedding.barycentric.row(v) = nearest.barycentric;
        embedding.normal.row(v) =
            interpolate(body_normal, body.triangle, nearest.triangle, nearest.barycentric).normalized();
    }
    embedding.tangent = vertex_u_axes(neutral_drape);
    for (int v = 0; v < vertices; ++v) {
        // What is left of a u axis along the normal is short, and gives way to its neighbours in the averaging.
        const Eigen::RowVector3d normal = embedding.normal.row(v);
        embedding.tangent.row(v) -= embedding.tangent.row(v).dot(normal) * normal;
    }
    embedding.edge = build_topology(neutral_drape.triangle).edge;
    embedding.smoothing = smoothing_rounds(embedding.edge, neutral_drape.rest_position);
    finish_frames(embedding);
    return embedding;
}

EmbeddedCloth carry(const Embedding& embedding, const skin::Body& body, const skin::Pose& pose,
                    const Positions& posed_body) {
    if (posed_body.rows() != body.vertex_count())
        throw Error("the posed body has " + std::to_string(posed_body.rows()) + " vertices, the body " +
                    std::to_string(body.vertex_count()));
    EmbeddedCloth embedded;
    embedded.position.resize(static_cast<int>(embedding.triangle.size()), 3);
    embedded.frame = parent_rotations(embedding, body, pose);
    for (int round = 0; round < embedding.smoothing; ++round) average(embedded.frame, embedding.edge);
    for (size_t v = 0; v < embedding.triangle.size(); ++v) {
        const int row = static_cast<int>(v);
        embedded.position.row(row) =
            interpolate(posed_body, body.triangle, embedding.triangle[v], embedding.barycentric.row(row));
        const Eigen::Vector3d normal = embedding.normal.row(row), tangent = embedding.tangent.row(row);
        Eigen::Matrix3d neutral;
        neutral << tangent, normal.cross(tangent), normal;
        Eigen::Quaterniond& frame = embedded.frame[v];
        frame = (frame * Eigen::Quaterniond(neutral)).normalized();
        if (frame.w() < 0.0) frame.coeffs() *= -1.0;
    }
    return embedded;
}

EmbeddedCloth rounded(const EmbeddedCloth& embedded) {
    EmbeddedCloth stored = embedded;
    stored.position = embedded.position.cast<float>().cast<double>();
    for (Eigen::Quaterniond& frame : stored.frame) frame = frame.cast<float>().cast<double>();
    return stored;
}

Positions displacement(const EmbeddedCloth& embedded, const Positions& cloth) {
    Positions local(cloth.rows(), 3);
    for (int v = 0; v < cloth.rows(); ++v) {
        const Eigen::Vector3d away = (cloth.row(v) - embedded.position.row(v)).transpose();
        local.row(v) = embedded.frame[v].inverse() * away;
    }
    return local;
}

Positions displaced(const EmbeddedCloth& embedded, const Positions& displacement) {
    Positions cloth(displacement.rows(), 3);
    for (int v = 0; v < cloth.rows(); ++v)
        cloth.row(v) = embedded.position.row(v) +
                       (embedded.frame[v] * Eigen::Vector3d(displacement.row(v).transpose())).transpose();
    return cloth;
}

}  // namespace toile::pattern
