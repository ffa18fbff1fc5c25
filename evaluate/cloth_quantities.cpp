#include "evaluate/cloth_quantities.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

namespace toile::evaluate {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double millimetres = 1e3, percent = 100.0;
constexpr double limit_slack = 1e-5;

double mean_angle(const Positions& a, const Positions& b) {
    double sum = 0;
    int counted = 0;
    for (Eigen::Index v = 0; v < a.rows(); ++v) {
        if (a.row(v).isZero(0.0) || b.row(v).isZero(0.0)) continue;
        // Well conditioned for small angles, which the arc cosine is not.
        const double angle = 2.0 * std::atan2((a.row(v) - b.row(v)).norm(), (a.row(v) + b.row(v)).norm());
        sum += angle * 180.0 / std::numbers::pi;
        ++counted;
    }
    return counted > 0 ? sum / counted : not_a_number;
}

/// e1·e1, e1·e2, e2·e2 of a triangle's first two edges.
template <typename Corner>
Eigen::RowVector3d edge_metric(const Corner& a, const Corner& b, const Corner& c) {
    const auto first = (b - a).eval(), second = (c - a).eval();
    return {first.dot(first), first.dot(second), second.dot(second)};
}

/// Largest principal stretch: the root of the largest eigenvalue of L⁻¹ now L⁻ᵀ, with L Lᵀ = rest. NaN for a triangle
/// without area.
double largest_stretch(const Eigen::RowVector3d& rest, const Eigen::RowVector3d& now) {
    const double first = std::sqrt(rest[0]), slant = rest[1] / first, second = std::sqrt(rest[2] - slant * slant);
    if (!(first > 0) || !(second > 0)) return not_a_number;
    const double a = now[0] / rest[0];
    const double b = (now[1] / first - slant * a) / second;
    const double c = ((now[2] - slant * now[1] / first) / second - slant * b) / second;
    return std::sqrt(0.5 * (a + c) + std::hypot(0.5 * (a - c), b));
}

}  // namespace

Positions area_weighted_normals(const Triangles& triangle, const Positions& position) {
    Positions normal = Positions::Zero(position.rows(), 3);
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(position.rows());
    for (Eigen::Index f = 0; f < triangle.rows(); ++f) {
        const Eigen::RowVector3d a = position.row(triangle(f, 0));
        const Eigen::RowVector3d cross =
            (position.row(triangle(f, 1)) - a).cross(position.row(triangle(f, 2)) - a).eval();
        for (int k = 0; k < 3; ++k) {
            normal.row(triangle(f, k)) += cross;
            whole[triangle(f, k)] += cross.norm();
        }
    }
    for (Eigen::Index v = 0; v < normal.rows(); ++v) {
        const double length = normal.row(v).norm();
        if (length > 1e-9 * whole[v])
            normal.row(v) /= length;
        else
            normal.row(v).setZero();
    }
    return normal;
}

double deepest_penetration(const skin::SurfaceQuery& body, const Positions& cloth, const Positions& known,
                           const Eigen::VectorXd& known_distance) {
    std::vector<std::pair<double, Eigen::Index>> inside;
    for (Eigen::Index v = 0; v < cloth.rows(); ++v) {
        if (known_distance[v] > (cloth.row(v) - known.row(v)).norm()) continue;
        const double distance = body.nearest(cloth.row(v).transpose()).signed_distance;
        if (distance < 0) inside.emplace_back(-distance, v);
    }
    std::sort(inside.begin(), inside.end(), std::greater<>());
    for (const auto& [depth, v] : inside)
        if (body.winding_number(cloth.row(v).transpose()) > 0.5) return depth;
    return 0.0;
}

ClothJudge::ClothJudge(const ClothMesh& mesh, double overstretched_limit, const std::string& where,
                       const prior::QuasistaticStiffness& stiffness)
    : mesh_(mesh),
      model_(prior::QuasistaticModel::from(prior::rest_state(mesh, where), stiffness)),
      overstretched_limit_(overstretched_limit),
      rest_metric_(mesh.triangle_count(), 3) {
    const bool flat = mesh.pattern_triangle.rows() > 0;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto corner = flat ? mesh.pattern_triangle.row(f) : mesh.triangle.row(f);
        const auto at = [&](int k) -> Eigen::RowVector3d {
            if (!flat) return mesh_.rest_position.row(corner[k]);
            return {mesh_.pattern_position(corner[k], 0), mesh_.pattern_position(corner[k], 1), 0.0};
        };
        rest_metric_.row(f) = edge_metric(at(0), at(1), at(2));
    }
}

JudgedTarget ClothJudge::target(Positions position, std::shared_ptr<const skin::SurfaceQuery> body) const {
    JudgedTarget target;
    target.position = std::move(position);
    target.normal = area_weighted_normals(mesh_.triangle, target.position);
    const Edges edges = judge_edges(target.position);
    target.stretching_energy = edges.stretching;
    target.compression_energy = edges.compression;
    target.body = std::move(body);
    if (!target.body) return target;
    target.body_distance.resize(target.position.rows());
    for (Eigen::Index v = 0; v < target.position.rows(); ++v)
        target.body_distance[v] = target.body->nearest(target.position.row(v).transpose()).signed_distance;
    return target;
}

ClothJudge::Edges ClothJudge::judge_edges(const Positions& cloth) const {
    Edges result;
    for (Eigen::Index e = 0; e < model_.edge_spring.rows(); ++e) {
        const double rest = model_.edge_rest_length[e];
        const double length = (cloth.row(model_.edge_spring(e, 0)) - cloth.row(model_.edge_spring(e, 1))).norm();
        const double energy = 0.5 * model_.edge_stiffness[e] * (length - rest) * (length - rest);
        (length > rest ? result.stretching : result.compression) += energy;
        result.overstretched += length > (1 + overstretched_limit_) * (1 + limit_slack) * rest;
        result.largest = std::max(result.largest, length / rest);
    }
    return result;
}

QuantityValues ClothJudge::judge(const Positions& cloth, const JudgedTarget& target) const {
    QuantityValues values;
    values.fill(not_a_number);
    if (!cloth.allFinite()) return values;
    const Eigen::VectorXd squared = (cloth - target.position).rowwise().squaredNorm();
    at(values, Quantity::sqrt_mse) = millimetres * std::sqrt(squared.mean());
    at(values, Quantity::max_dist) = millimetres * std::sqrt(squared.maxCoeff());
    const Edges edges = judge_edges(cloth);
    at(values, Quantity::stretching_energy) = edges.stretching;
    at(values, Quantity::compression_energy) = edges.compression;
    at(values, Quantity::stretching_energy_error) = std::abs(edges.stretching - target.stretching_energy);
    at(values, Quantity::compression_energy_error) = std::abs(edges.compression - target.compression_energy);
    at(values, Quantity::normal_error) = mean_angle(area_weighted_normals(mesh_.triangle, cloth), target.normal);
    const auto edge_count = static_cast<double>(std::max<Eigen::Index>(model_.edge_spring.rows(), 1));
    at(values, Quantity::overstretched_share) = percent * edges.overstretched / edge_count;
    at(values, Quantity::largest_stretch) = edges.largest;
    if (target.body)
        at(values, Quantity::penetration) =
            millimetres * deepest_penetration(*target.body, cloth, target.position, target.body_distance);
    return values;
}

Eigen::VectorXd ClothJudge::vertex_strain(const Positions& cloth) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(cloth.rows()), weight = sum;
    for (int f = 0; f < mesh_.triangle_count(); ++f) {
        const auto corner = mesh_.triangle.row(f);
        const double strain =
            largest_stretch(rest_metric_.row(f), edge_metric(cloth.row(corner[0]).eval(), cloth.row(corner[1]).eval(),
                                                             cloth.row(corner[2]).eval())) -
            1.0;
        if (!std::isfinite(strain)) continue;
        const auto rest = rest_metric_.row(f);
        const double area = 0.5 * std::sqrt(rest[0] * rest[2] - rest[1] * rest[1]);
        for (int k = 0; k < 3; ++k) {
            sum[corner[k]] += area * strain;
            weight[corner[k]] += area;
        }
    }
    for (Eigen::Index v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0 ? sum[v] / weight[v] : 0.0;
    return sum;
}

ClothFields ClothJudge::fields(const Positions& cloth, const Positions& target) const {
    ClothFields fields;
    fields.distance = (cloth - target).rowwise().norm();
    fields.strain = vertex_strain(cloth);
    fields.stretch = Eigen::VectorXd::Ones(cloth.rows());
    for (Eigen::Index e = 0; e < model_.edge_spring.rows(); ++e) {
        const int end[2] = {model_.edge_spring(e, 0), model_.edge_spring(e, 1)};
        const double stretch = (cloth.row(end[0]) - cloth.row(end[1])).norm() / model_.edge_rest_length[e];
        for (const int v : end)
            if (std::abs(stretch - 1) > std::abs(fields.stretch[v] - 1)) fields.stretch[v] = stretch;
    }
    return fields;
}

}  // namespace toile::evaluate
