#include "cloth/fold.h"

#include <Eigen/Geometry>
#include <cmath>

namespace toile {
namespace {

/// Share of its pattern area below which a triangle's angle begins to count less.
constexpr double taper_share = 0.05;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
}

/// One triangle of the hinge, seen from the shared edge e: with its apex at `apex` from a, and the sign that makes both
/// triangles' normals agree where the hinge is flat.
struct Wing {
    Eigen::Vector3d apex, normal;  // normal = sign e x apex, not of unit length
    double length;                 // |normal|
    double foot;                   // where the apex stands over the edge: 0 at a, 1 at b
    Eigen::Vector3d lever;         // |e| normal / |normal|²: the angle's rate with the apex' motion is its negative

    Wing(const Eigen::Vector3d& e, const Eigen::Vector3d& from_a, double sign) : apex(from_a) {
        normal = sign * e.cross(apex);
        length = normal.norm();
        foot = apex.dot(e) / e.squaredNorm();
        lever = e.norm() / (length * length) * normal;
    }
};

struct Fold {
    Eigen::Vector3d e;
    Wing first, second;
    double angle;

    explicit Fold(const HingePositions& x)
        : e(x.col(1) - x.col(0)), first(e, x.col(2) - x.col(0), 1.0), second(e, x.col(3) - x.col(0), -1.0) {
        angle = std::atan2(e.dot(first.normal.cross(second.normal)) / e.norm(), first.normal.dot(second.normal));
    }
};

bool has_angle(const HingePositions& x) {
    const Eigen::Vector3d e = x.col(1) - x.col(0), c = x.col(2) - x.col(0), d = x.col(3) - x.col(0);
    return e.cross(c).squaredNorm() > 0.0 && e.cross(d).squaredNorm() > 0.0;
}

/// m(length) and its derivative: a quintic step from 0 to 1.
struct Taper {
    double value = 1.0, slope = 0.0;
    Taper(double length, double full) {
        if (length >= full) return;
        const double t = length / full;
        value = t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
        slope = 30.0 * t * t * (1.0 - t) * (1.0 - t) / full;
    }
};

FoldGradient angle_gradient(const Fold& fold) {
    const Wing &c = fold.first, &d = fold.second;
    FoldGradient gradient;
    gradient << (1.0 - c.foot) * c.lever + (1.0 - d.foot) * d.lever, c.foot * c.lever + d.foot * d.lever, -c.lever,
        -d.lever;
    return gradient;
}

/// Adds `factor` times the gradient of |normal| of the wing whose apex is column `apex`, normal = sign e x apex.
void add_length_gradient(const Eigen::Vector3d& e, const Wing& wing, double sign, int apex, double factor,
                         FoldGradient& gradient) {
    const Eigen::Vector3d unit = sign / wing.length * wing.normal;
    const Eigen::Vector3d by_edge = wing.apex.cross(unit), by_apex = unit.cross(e);
    gradient.segment<3>(0) -= factor * (by_edge + by_apex);
    gradient.segment<3>(3) += factor * by_edge;
    gradient.segment<3>(3 * apex) += factor * by_apex;
}

/// Derivatives of one wing's lever and foot in e and its apex, gathered into those of the angle's gradient: rows a, b
/// and `apex` of `rates` `[12 x 9]`, whose columns are e, c − a, d − a.
void add_wing_rates(const Eigen::Vector3d& e, const Wing& wing, double sign, int apex,
                    Eigen::Matrix<double, 12, 9>& rates) {
    const double squared = wing.length * wing.length, edge = e.norm();
    const Eigen::Matrix3d mirror =
        edge / squared * (Eigen::Matrix3d::Identity() - 2.0 / squared * wing.normal * wing.normal.transpose());
    const Eigen::Matrix3d lever_by_edge =
        wing.normal * e.transpose() / (squared * edge) - sign * mirror * cross_matrix(wing.apex);
    const Eigen::Matrix3d lever_by_apex = sign * mirror * cross_matrix(e);
    const Eigen::RowVector3d foot_by_edge = (wing.apex - 2.0 * wing.foot * e).transpose() / (edge * edge);
    const Eigen::RowVector3d foot_by_apex = e.transpose() / (edge * edge);
    const int column = 3 * (apex - 1);
    const auto add = [&](int at, const Eigen::Matrix3d& lever, const Eigen::RowVector3d& foot) {
        rates.block<3, 3>(0, at) += (1.0 - wing.foot) * lever - wing.lever * foot;
        rates.block<3, 3>(3, at) += wing.foot * lever + wing.lever * foot;
        rates.block<3, 3>(3 * apex, at) -= lever;
    };
    add(0, lever_by_edge, foot_by_edge);
    add(column, lever_by_apex, foot_by_apex);
}

/// Second derivatives of the angle (Tamstorf, Grinspun 2013, "Discrete bending forces and their Jacobians", in other
/// letters).
FoldHessian angle_hessian(const Fold& fold) {
    Eigen::Matrix<double, 12, 9> rates = Eigen::Matrix<double, 12, 9>::Zero();
    add_wing_rates(fold.e, fold.first, 1.0, 2, rates);
    add_wing_rates(fold.e, fold.second, -1.0, 3, rates);
    FoldHessian hessian;
    hessian.rightCols<9>() = rates;  // e, c − a and d − a move with b, c and d, and against a
    hessian.leftCols<3>() = -rates.leftCols<3>() - rates.middleCols<3>(3) - rates.rightCols<3>();
    return hessian;
}

double edge_length(const ClothMesh& mesh, int triangle, int a, int b) {
    Eigen::RowVector2d at_a = Eigen::RowVector2d::Zero(), at_b = at_a;
    for (int corner = 0; corner < 3; ++corner) {
        const Eigen::RowVector2d p = mesh.pattern_position.row(mesh.pattern_triangle(triangle, corner));
        if (mesh.triangle(triangle, corner) == a) at_a = p;
        if (mesh.triangle(triangle, corner) == b) at_b = p;
    }
    return (at_b - at_a).norm();
}

double pattern_area(const ClothMesh& mesh, int triangle) {
    const auto t = mesh.pattern_triangle.row(triangle);
    const Eigen::RowVector2d p = mesh.pattern_position.row(t[1]) - mesh.pattern_position.row(t[0]);
    const Eigen::RowVector2d q = mesh.pattern_position.row(t[2]) - mesh.pattern_position.row(t[0]);
    return 0.5 * std::abs(p.x() * q.y() - p.y() * q.x());
}

}  // namespace

double fold_angle(const HingePositions& x) {
    return has_angle(x) ? Fold(x).angle : 0.0;
}

FoldStencil fold_stencil(const ClothMesh& mesh, const Eigen::Vector4i& hinge, int first, int second) {
    const double area[2] = {pattern_area(mesh, first), pattern_area(mesh, second)};
    const double edge =
        0.5 * (edge_length(mesh, first, hinge[0], hinge[1]) + edge_length(mesh, second, hinge[0], hinge[1]));
    HingePositions rest;
    for (int i = 0; i < 4; ++i) rest.col(i) = mesh.rest_position.row(hinge[i]).transpose();
    return {edge * edge / (area[0] + area[1]), fold_angle(rest), 2.0 * taper_share * Eigen::Vector2d(area[0], area[1])};
}

double fold_energy(const FoldStencil& stencil, double stiffness, const HingePositions& x) {
    if (!has_angle(x)) return 0.0;
    const Fold fold(x);
    const double half = std::sin(0.5 * (fold.angle - stencil.rest_angle));
    const Taper first(fold.first.length, stencil.taper[0]), second(fold.second.length, stencil.taper[1]);
    return 2.0 * stiffness * stencil.scale * half * half * first.value * second.value;
}

FoldGradient fold_gradient(const FoldStencil& stencil, double stiffness, const HingePositions& x) {
    if (!has_angle(x)) return FoldGradient::Zero();
    const Fold fold(x);
    const double turn = fold.angle - stencil.rest_angle, half = std::sin(0.5 * turn), k = stiffness * stencil.scale;
    const Taper first(fold.first.length, stencil.taper[0]), second(fold.second.length, stencil.taper[1]);
    FoldGradient gradient = (k * std::sin(turn) * first.value * second.value) * angle_gradient(fold);
    const double energy = 2.0 * k * half * half;
    if (first.slope != 0.0)
        add_length_gradient(fold.e, fold.first, 1.0, 2, energy * first.slope * second.value, gradient);
    if (second.slope != 0.0)
        add_length_gradient(fold.e, fold.second, -1.0, 3, energy * first.value * second.slope, gradient);
    return gradient;
}

FoldMeasure fold_measure(const FoldStencil& stencil, const HingePositions& x) {
    FoldMeasure measure;
    if (!has_angle(x)) return measure;
    const Fold fold(x);
    const double half = 0.5 * (fold.angle - stencil.rest_angle);
    const Taper first(fold.first.length, stencil.taper[0]), second(fold.second.length, stencil.taper[1]);
    const double size = std::sqrt(stencil.scale * first.value * second.value);
    measure.value = 2.0 * size * std::sin(half);
    measure.gradient = size * std::cos(half) * angle_gradient(fold);
    const auto add_taper = [&](const Wing& wing, const Taper& taper, double sign, int apex) {
        if (taper.slope != 0.0 && taper.value > 0.0)
            add_length_gradient(fold.e, wing, sign, apex, 0.5 * measure.value * taper.slope / taper.value,
                                measure.gradient);
    };
    add_taper(fold.first, first, 1.0, 2);
    add_taper(fold.second, second, -1.0, 3);
    return measure;
}

FoldHessian fold_hessian(const FoldStencil& stencil, double stiffness, const HingePositions& x) {
    if (!has_angle(x)) return FoldHessian::Zero();
    const Fold fold(x);
    const double turn = fold.angle - stencil.rest_angle;
    const Taper first(fold.first.length, stencil.taper[0]), second(fold.second.length, stencil.taper[1]);
    const double k = stiffness * stencil.scale * first.value * second.value;
    const FoldGradient rate = angle_gradient(fold);
    return k * std::cos(turn) * rate * rate.transpose() + k * std::sin(turn) * angle_hessian(fold);
}

FoldHessian fold_projected_hessian(const FoldStencil& stencil, double stiffness, const HingePositions& x) {
    if (!has_angle(x)) return FoldHessian::Zero();
    const Fold fold(x);
    const double half = std::cos(0.5 * (fold.angle - stencil.rest_angle));
    const Taper first(fold.first.length, stencil.taper[0]), second(fold.second.length, stencil.taper[1]);
    const FoldGradient rate = angle_gradient(fold);
    return (stiffness * stencil.scale * half * half * first.value * second.value) * rate * rate.transpose();
}

}  // namespace toile
