#include "simulate/spring_network.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/bending.h"
#include "cloth/fold.h"
#include "cloth/membrane.h"

namespace toile::simulate {
namespace {

/// The fold at which a bending spring stores what the hinge stores [rad].
constexpr double reference_fold = 1.0;
/// Least stiffness of an edge over what an isotropic cloth of the softer direction would give it: an edge without a
/// spring would let its triangle collapse.
constexpr double least_share = 0.1;

using Form = Eigen::Vector4d;  // uu, vv, ss, √2 uv: weighted as in the matrix' Frobenius norm

Form membrane_form(const MembraneOptions& options) {
    const MembraneStiffness c = MembraneStiffness::from_moduli(options.weft_stiffness, options.warp_stiffness,
                                                               options.shear_stiffness, options.poisson_ratio);
    Form form;
    form << c.uu, c.vv, c.shear, std::sqrt(2.0) * c.uv;
    return form;
}

/// Of a spring of unit stiffness along `edge` in a triangle of that area.
Form spring_form(const Eigen::Vector2d& edge, double area) {
    const Eigen::Vector2d t = edge.normalized();
    const double uu = t.x() * t.x(), vv = t.y() * t.y(), uv = t.x() * t.y();
    Form form;
    form << uu * uu, vv * vv, uv * uv, std::sqrt(2.0) * uu * vv;
    return edge.squaredNorm() / area * form;
}

/// min |M k − target| over k ≥ 0: of the sets of springs that are not zero, the one that fits best.
Eigen::Vector3d nonnegative_fit(const Eigen::Matrix<double, 4, 3>& m, const Form& target) {
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (int set = 1; set < 8; ++set) {
        Eigen::Matrix3d normal = m.transpose() * m;
        Eigen::Vector3d right = m.transpose() * target;
        for (int i = 0; i < 3; ++i) {
            if (set >> i & 1) continue;
            normal.row(i).setZero();
            normal.col(i).setZero();
            normal(i, i) = 1.0;
            right[i] = 0.0;
        }
        const Eigen::Vector3d k = normal.fullPivLu().solve(right);
        if (!k.allFinite() || k.minCoeff() < 0.0) continue;
        const double misfit = (m * k - target).squaredNorm();
        if (misfit < least) {
            least = misfit;
            best = k;
        }
    }
    return best;
}

/// A triangle over one of its edges in the flat pattern.
struct Apex {
    double along, height;  ///< of the third vertex, from the edge's middle [m]
    double edge;           ///< [m]
};

Apex apex_over(const ClothMesh& mesh, int triangle, int a, int b) {
    Eigen::Vector2d at_a = Eigen::Vector2d::Zero(), at_b = at_a, apex = at_a;
    for (int corner = 0; corner < 3; ++corner) {
        const Eigen::Vector2d p = mesh.pattern_position.row(mesh.pattern_triangle(triangle, corner)).transpose();
        const int v = mesh.triangle(triangle, corner);
        (v == a ? at_a : v == b ? at_b : apex) = p;
    }
    const Eigen::Vector2d edge = at_b - at_a, from_middle = apex - 0.5 * (at_a + at_b);
    const double length = edge.norm();
    return {from_middle.dot(edge) / length, std::abs(edge.x() * from_middle.y() - edge.y() * from_middle.x()) / length,
            length};
}

/// The angle a hinge starts from; a spring does not know which way it folds.
double start_fold(const Positions& x, const Eigen::Vector4i& hinge) {
    HingePositions columns;
    for (int i = 0; i < 4; ++i) columns.col(i) = x.row(hinge[i]).transpose();
    return std::abs(fold_angle(columns));
}

}  // namespace

std::vector<Spring> membrane_springs(const ClothMesh& mesh, const Topology& topology,
                                     const Eigen::VectorXd& rest_length, const MembraneOptions& options) {
    std::vector<Spring> springs(static_cast<size_t>(topology.edge.rows()));
    for (size_t e = 0; e < springs.size(); ++e) {
        const int row = static_cast<int>(e);
        springs[e] = {topology.edge(row, 0), topology.edge(row, 1), rest_length[row], 0.0};
    }
    const Form target = membrane_form(options);
    const double softer = std::min(options.warp_stiffness, options.weft_stiffness);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto p = mesh.pattern_triangle.row(f);
        const double area = membrane_stencil(mesh, f).area;
        Eigen::Matrix<double, 4, 3> forms;
        Eigen::Vector3d least;
        for (int corner = 0; corner < 3; ++corner) {
            const Eigen::Vector2d edge =
                (mesh.pattern_position.row(p[(corner + 2) % 3]) - mesh.pattern_position.row(p[(corner + 1) % 3]))
                    .transpose();
            forms.col(corner) = spring_form(edge, area);
            least[corner] = least_share * softer * area / edge.squaredNorm();
        }
        const Eigen::Vector3d stiffness = nonnegative_fit(forms, target).cwiseMax(least);
        for (int corner = 0; corner < 3; ++corner)
            springs[topology.triangle_edge(f, corner)].stiffness += stiffness[corner];
    }
    return springs;
}

std::vector<Spring> bending_springs(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options) {
    std::vector<Spring> springs;
    const auto hinges = build_hinges(topology, mesh.triangle);
    int h = 0;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const int first = topology.edge_triangle(e, 0), second = topology.edge_triangle(e, 1);
        if (second < 0) continue;
        const Eigen::Vector4i hinge = hinges.row(h++).transpose();
        const Apex c = apex_over(mesh, first, hinge[0], hinge[1]);
        const Apex d = apex_over(mesh, second, hinge[0], hinge[1]);
        auto length_at = [&](double fold) {
            const double along = c.along - d.along, open = c.height + d.height;
            return std::sqrt(
                std::max(0.0, along * along + open * open - 2.0 * c.height * d.height * (1.0 - std::cos(fold))));
        };
        const double rest_fold = options.rest == BendingRest::start ? start_fold(mesh.rest_position, hinge) : 0.0;
        const double rest_length = length_at(rest_fold);
        const double shortening = rest_length - length_at(rest_fold + reference_fold);
        const BendingStencil stencil = bending_stencil(mesh, hinge, first, second);
        // On a seam either panel has its own length of the shared edge.
        const double curvature = (c.edge + d.edge) * std::sin(0.5 * reference_fold);
        springs.push_back({hinge[2], hinge[3], rest_length,
                           options.stiffness * stencil.scale * curvature * curvature / (shortening * shortening)});
    }
    return springs;
}

}  // namespace toile::simulate
