#include "simulate/elasticity.h"

#include <algorithm>

namespace toile::simulate {
namespace {

constexpr int hinge_pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

}  // namespace

Elasticity::Elasticity(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
                       const std::optional<BendingOptions>& bending, const Eigen::Vector3d& gravity)
    : mesh_(mesh),
      stiffness_(MembraneStiffness::from_moduli(membrane.weft_stiffness, membrane.warp_stiffness,
                                                membrane.shear_stiffness, membrane.poisson_ratio)),
      weight_(mesh.mass * gravity.transpose()) {
    for (int f = 0; f < mesh.triangle_count(); ++f) membrane_.push_back(membrane_stencil(mesh, f));
    if (!bending) return;
    bending_stiffness_ = bending->stiffness;
    hinge_ = build_hinges(topology, mesh.triangle);
    int h = 0;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        if (topology.edge_triangle(e, 1) < 0) continue;
        bending_.push_back(bending_stencil(mesh, hinge_.row(h++).transpose(), topology.edge_triangle(e, 0),
                                           topology.edge_triangle(e, 1)));
    }
}

std::vector<std::pair<int, int>> Elasticity::pairs() const {
    std::vector<std::pair<int, int>> pairs;
    for (int f = 0; f < mesh_.triangle_count(); ++f)
        for (int i = 0; i < 3; ++i) pairs.emplace_back(mesh_.triangle(f, i), mesh_.triangle(f, (i + 1) % 3));
    for (int h = 0; h < hinge_.rows(); ++h)
        for (const auto& [i, j] : hinge_pair) pairs.emplace_back(hinge_(h, i), hinge_(h, j));
    return pairs;
}

void Elasticity::bind(const BlockSymbolic& symbolic) {
    for (int f = 0; f < mesh_.triangle_count(); ++f) {
        const auto t = mesh_.triangle.row(f);
        membrane_slot_.push_back({symbolic.slot(t[0], t[1]), symbolic.slot(t[1], t[2]), symbolic.slot(t[2], t[0])});
    }
    for (int h = 0; h < hinge_.rows(); ++h) {
        std::array<int, 6>& slots = bending_slot_.emplace_back();
        for (int k = 0; k < 6; ++k) slots[k] = symbolic.slot(hinge_(h, hinge_pair[k][0]), hinge_(h, hinge_pair[k][1]));
    }
}

TrianglePositions Elasticity::corners(const Positions& x, int triangle) const {
    const auto t = mesh_.triangle.row(triangle);
    TrianglePositions columns;
    for (int i = 0; i < 3; ++i) columns.col(i) = x.row(t[i]).transpose();
    return columns;
}

double Elasticity::energy(const Positions& x) const {
    double energy = -(weight_.cwiseProduct(x)).sum();
    for (int f = 0; f < mesh_.triangle_count(); ++f) energy += membrane_energy(membrane_[f], stiffness_, corners(x, f));
    for (int h = 0; h < hinge_.rows(); ++h) {
        HingePositions columns;
        for (int i = 0; i < 4; ++i) columns.col(i) = x.row(hinge_(h, i)).transpose();
        energy += bending_energy(bending_[h], bending_stiffness_, columns);
    }
    return energy;
}

void Elasticity::add_gradient(const Positions& x, Positions& gradient) const {
    gradient -= weight_;
    for (int f = 0; f < mesh_.triangle_count(); ++f) {
        const TriangleGradient local = membrane_gradient(membrane_[f], stiffness_, corners(x, f));
        for (int i = 0; i < 3; ++i) gradient.row(mesh_.triangle(f, i)) += local.segment<3>(3 * i).transpose();
    }
    for (int h = 0; h < hinge_.rows(); ++h) {
        HingePositions columns;
        for (int i = 0; i < 4; ++i) columns.col(i) = x.row(hinge_(h, i)).transpose();
        const Eigen::Matrix<double, 12, 1> local = bending_gradient(bending_[h], bending_stiffness_, columns);
        for (int i = 0; i < 4; ++i) gradient.row(hinge_(h, i)) += local.segment<3>(3 * i).transpose();
    }
}

void Elasticity::add_hessian(const Positions& x, BlockValues& hessian) const {
    for (int f = 0; f < mesh_.triangle_count(); ++f) {
        const auto t = mesh_.triangle.row(f);
        const TrianglePositions columns = corners(x, f);
        const TriangleHessian local = membrane_projected_hessian(membrane_[f], stiffness_, columns);
        for (int i = 0; i < 3; ++i) {
            hessian.add(t[i], local.block<3, 3>(3 * i, 3 * i));
            const int j = (i + 1) % 3;
            const bool row_is_larger = t[i] > t[j];
            const Eigen::Matrix3d block =
                row_is_larger ? local.block<3, 3>(3 * i, 3 * j) : local.block<3, 3>(3 * j, 3 * i);
            hessian.add(membrane_slot_[f][i], block);
        }
    }
    for (int h = 0; h < hinge_.rows(); ++h) {
        const Eigen::Matrix4d local = bending_hessian(bending_[h], bending_stiffness_);
        for (int i = 0; i < 4; ++i) hessian.add_identity(hinge_(h, i), local(i, i));
        for (int k = 0; k < 6; ++k) {
            const auto& [i, j] = hinge_pair[k];
            hessian.add_identity(bending_slot_[h][k], local(i, j));
        }
    }
}

}  // namespace toile::simulate
