#include "cloth/bending.h"

#include <cmath>

namespace toile {
namespace {

struct PatternTriangle {
    double area;
    double cotangent_a, cotangent_b;  // of the angles at the shared edge's ends
};

/// Angles at the ends of edge (a, b) in one triangle's pattern. On a seam the two triangles see the edge in their own
/// panels.
PatternTriangle pattern_triangle(const ClothMesh& mesh, int triangle, int a, int b) {
    Eigen::Vector2d at_a = Eigen::Vector2d::Zero(), at_b = at_a, opposite = at_a;
    for (int corner = 0; corner < 3; ++corner) {
        const Eigen::Vector2d p = mesh.pattern_position.row(mesh.pattern_triangle(triangle, corner)).transpose();
        const int v = mesh.triangle(triangle, corner);
        (v == a ? at_a : v == b ? at_b : opposite) = p;
    }
    const Eigen::Vector2d edge = at_b - at_a, to_opposite = opposite - at_a;
    const double twice_area = std::abs(edge.x() * to_opposite.y() - edge.y() * to_opposite.x());
    return {0.5 * twice_area, edge.dot(to_opposite) / twice_area, edge.dot(at_b - opposite) / twice_area};
}

}  // namespace

BendingStencil bending_stencil(const ClothMesh& mesh, const Eigen::Vector4i& hinge, int first, int second) {
    const PatternTriangle t0 = pattern_triangle(mesh, first, hinge[0], hinge[1]);
    const PatternTriangle t1 = pattern_triangle(mesh, second, hinge[0], hinge[1]);
    BendingStencil stencil;
    stencil.weight << t0.cotangent_b + t1.cotangent_b, t0.cotangent_a + t1.cotangent_a,
        -t0.cotangent_a - t0.cotangent_b, -t1.cotangent_a - t1.cotangent_b;
    stencil.scale = 1.0 / (t0.area + t1.area);
    return stencil;
}

double bending_energy(const BendingStencil& stencil, double stiffness, const HingePositions& x) {
    return 0.5 * stiffness * stencil.scale * (x * stencil.weight).squaredNorm();
}

Eigen::Matrix<double, 12, 1> bending_gradient(const BendingStencil& stencil, double stiffness,
                                              const HingePositions& x) {
    const Eigen::Vector3d curvature = stiffness * stencil.scale * (x * stencil.weight);
    Eigen::Matrix<double, 12, 1> gradient;
    for (int i = 0; i < 4; ++i) gradient.segment<3>(3 * i) = stencil.weight[i] * curvature;
    return gradient;
}

Eigen::Matrix4d bending_hessian(const BendingStencil& stencil, double stiffness) {
    return stiffness * stencil.scale * stencil.weight * stencil.weight.transpose();
}

}  // namespace toile
