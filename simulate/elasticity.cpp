#include "simulate/elasticity.h"

#include <algorithm>
#include <cmath>

namespace toile::simulate {
namespace {

/// Where flat hinges' blocks between opposite vertices are less than this share of the membrane's, they go to the
/// diagonal: Newton's matrix then has the mesh' own graph, which factors three times faster, and takes no more steps.
constexpr double weak_bending = 0.001;

bool is_opposite(int i, int j) {
    return i == 2 && j == 3;
}

constexpr int hinge_pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// Tension that a cloth 1 % beyond its strain limit carries at least [N/m]: some hundred times what a garment's weight
/// asks of it.
constexpr double least_limit_tension = 500.0;

Eigen::Map<const Eigen::Vector3d> at(const Positions& x, int vertex) {
    return Eigen::Map<const Eigen::Vector3d>(x.data() + 3 * static_cast<std::ptrdiff_t>(vertex));
}
Eigen::Map<Eigen::Vector3d> at(Positions& x, int vertex) {
    return Eigen::Map<Eigen::Vector3d>(x.data() + 3 * static_cast<std::ptrdiff_t>(vertex));
}

template <std::size_t N>
Eigen::Matrix<double, 3, static_cast<int>(N)> gather(const Positions& x, const std::array<int, N>& vertex) {
    Eigen::Matrix<double, 3, static_cast<int>(N)> columns;
    for (std::size_t i = 0; i < N; ++i) columns.col(static_cast<int>(i)) = at(x, vertex[i]);
    return columns;
}

template <std::size_t N, class Local>
void scatter(const Local& local, const std::array<int, N>& vertex, Positions& gradient) {
    for (std::size_t i = 0; i < N; ++i) at(gradient, vertex[i]) += local.template segment<3>(3 * static_cast<int>(i));
}

}  // namespace

Elasticity::Elasticity(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
                       const std::optional<BendingOptions>& bending, const Eigen::Vector3d& gravity,
                       const std::optional<StrainLimitOptions>& strain_limit)
    : stiffness_(MembraneStiffness::from_moduli(membrane.weft_stiffness, membrane.warp_stiffness,
                                                membrane.shear_stiffness, membrane.poisson_ratio,
                                                membrane.compression)),
      weight_(mesh.mass * gravity.transpose()) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto t = mesh.triangle.row(f);
        triangle_.push_back({{t[0], t[1], t[2]}, {}, membrane_stencil(mesh, f)});
    }
    if (bending) add_bending(mesh, topology, *bending);
    if (strain_limit) add_strain_limit(membrane, *strain_limit, weight_.colwise().sum().norm());
}

void Elasticity::add_bending(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options) {
    bending_stiffness_ = options.stiffness;
    const auto hinge = build_hinges(topology, mesh.triangle);
    int h = 0;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        const int first = topology.edge_triangle(e, 0), second = topology.edge_triangle(e, 1);
        if (second < 0) continue;
        const Eigen::Vector4i v = hinge.row(h++).transpose();
        const std::array<int, 4> vertex = {v[0], v[1], v[2], v[3]};
        if (options.rest == BendingRest::start) {
            folded_hinge_.push_back({vertex, {}, fold_stencil(mesh, v, first, second)});
        } else {
            const BendingStencil stencil = bending_stencil(mesh, v, first, second);
            flat_hinge_.push_back({vertex, std::sqrt(options.stiffness * stencil.scale) * stencil.weight});
        }
    }
    double opposite = 0.0;
    for (const FlatHinge& hinge : flat_hinge_) opposite += std::abs(hinge.weight[2] * hinge.weight[3]);
    const double mean = opposite / std::max<double>(1.0, static_cast<double>(flat_hinge_.size()));
    couples_opposite_ = mean > weak_bending * std::min(stiffness_.uu, stiffness_.vv);
}

void Elasticity::add_strain_limit(const MembraneOptions& membrane, const StrainLimitOptions& options, double weight) {
    // All of the weight on one triangle's width is the most that a pin can ask for.
    double area = 0.0;
    for (const Triangle& triangle : triangle_) area += triangle.stencil.area;
    const double width = std::sqrt(2.0 * area / static_cast<double>(triangle_.size()));
    const double stiffness = std::max(membrane.warp_stiffness, membrane.weft_stiffness);
    const double tension = std::max({least_limit_tension, 0.5 * stiffness, weight / width});
    strain_limit_ = StrainLimit::carrying(options.weft, options.warp, tension);
}

std::vector<std::pair<int, int>> Elasticity::pairs() const {
    std::vector<std::pair<int, int>> pairs;
    for (const Triangle& t : triangle_)
        for (int i = 0; i < 3; ++i) pairs.emplace_back(t.vertex[i], t.vertex[(i + 1) % 3]);
    for (const auto& [i, j] : hinge_pair) {
        if (couples_opposite_ || !is_opposite(i, j))
            for (const FlatHinge& hinge : flat_hinge_) pairs.emplace_back(hinge.vertex[i], hinge.vertex[j]);
        for (const FoldedHinge& hinge : folded_hinge_) pairs.emplace_back(hinge.vertex[i], hinge.vertex[j]);
    }
    return pairs;
}

void Elasticity::bind(const BlockSymbolic& symbolic) {
    pair_ = symbolic.pair();
    opposite_.clear();
    for (Triangle& t : triangle_)
        for (int i = 0; i < 3; ++i) t.slot[i] = symbolic.slot(t.vertex[i], t.vertex[(i + 1) % 3]);
    for (FoldedHinge& hinge : folded_hinge_)
        for (int k = 0; k < 6; ++k)
            hinge.slot[k] = symbolic.slot(hinge.vertex[hinge_pair[k][0]], hinge.vertex[hinge_pair[k][1]]);
    if (flat_hinge_.empty()) return;
    flat_hessian_.assign(symbolic.slot_count(), 0.0);
    for (const FlatHinge& hinge : flat_hinge_) {
        for (int i = 0; i < 4; ++i) flat_hessian_[hinge.vertex[i]] += hinge.weight[i] * hinge.weight[i];
        for (const auto& [i, j] : hinge_pair) {
            const double value = hinge.weight[i] * hinge.weight[j];
            if (couples_opposite_ || !is_opposite(i, j)) {
                flat_hessian_[symbolic.slot(hinge.vertex[i], hinge.vertex[j])] += value;
            } else {
                flat_hessian_[hinge.vertex[i]] += std::abs(value);
                flat_hessian_[hinge.vertex[j]] += std::abs(value);
                opposite_.push_back({hinge.vertex[i], hinge.vertex[j], value});
            }
        }
    }
}

double Elasticity::energy(const Positions& x) const {
    double energy = -(weight_.cwiseProduct(x)).sum();
    for (const Triangle& t : triangle_) energy += membrane_energy(t.stencil, stiffness_, gather(x, t.vertex));
    if (strain_limit_)
        for (const Triangle& t : triangle_)
            energy += strain_limit_energy(t.stencil, *strain_limit_, gather(x, t.vertex));
    for (const FlatHinge& hinge : flat_hinge_) energy += 0.5 * (gather(x, hinge.vertex) * hinge.weight).squaredNorm();
    for (const FoldedHinge& hinge : folded_hinge_)
        energy += fold_energy(hinge.stencil, bending_stiffness_, gather(x, hinge.vertex));
    return energy;
}

void Elasticity::add_gradient(const Positions& x, Positions& gradient) const {
    gradient -= weight_;
    for (const Triangle& t : triangle_)
        scatter(membrane_gradient(t.stencil, stiffness_, gather(x, t.vertex)), t.vertex, gradient);
    if (strain_limit_)
        for (const Triangle& t : triangle_)
            scatter(strain_limit_gradient(t.stencil, *strain_limit_, gather(x, t.vertex)), t.vertex, gradient);
    for (const FlatHinge& hinge : flat_hinge_) {
        const Eigen::Vector3d curvature = gather(x, hinge.vertex) * hinge.weight;
        for (int i = 0; i < 4; ++i) at(gradient, hinge.vertex[i]) += hinge.weight[i] * curvature;
    }
    for (const FoldedHinge& hinge : folded_hinge_)
        scatter(fold_gradient(hinge.stencil, bending_stiffness_, gather(x, hinge.vertex)), hinge.vertex, gradient);
}

void Elasticity::add_hessian(const Triangle& t, const TriangleHessian& local, BlockValues& hessian) const {
    for (int i = 0; i < 3; ++i) {
        hessian.add(t.vertex[i], local.block<3, 3>(3 * i, 3 * i));
        const int j = (i + 1) % 3;
        const bool row_is_larger = t.vertex[i] > t.vertex[j];
        const int row = row_is_larger ? i : j, column = row_is_larger ? j : i;
        hessian.add(t.slot[i], local.block<3, 3>(3 * row, 3 * column));
    }
}

void Elasticity::add_hessian(const FoldedHinge& hinge, const FoldHessian& local, BlockValues& hessian) const {
    for (int i = 0; i < 4; ++i) hessian.add(hinge.vertex[i], local.block<3, 3>(3 * i, 3 * i));
    for (int k = 0; k < 6; ++k) {
        const auto& [i, j] = hinge_pair[k];
        const bool row_is_larger = hinge.vertex[i] > hinge.vertex[j];
        const int row = row_is_larger ? i : j, column = row_is_larger ? j : i;
        hessian.add(hinge.slot[k], local.block<3, 3>(3 * row, 3 * column));
    }
}

void Elasticity::add_hessian(const Positions& x, BlockValues& hessian) const {
    for (const Triangle& t : triangle_) {
        const TrianglePositions corners = gather(x, t.vertex);
        add_hessian(t, membrane_projected_hessian(t.stencil, stiffness_, corners), hessian);
        if (strain_limit_ && strain_limit_acts(t.stencil, *strain_limit_, corners))
            add_hessian(t, strain_limit_hessian(t.stencil, *strain_limit_, corners), hessian);
    }
    for (std::size_t slot = 0; slot < flat_hessian_.size(); ++slot)
        if (flat_hessian_[slot] != 0.0) hessian.add_identity(static_cast<int>(slot), flat_hessian_[slot]);
    for (const FoldedHinge& hinge : folded_hinge_)
        add_hessian(hinge, fold_projected_hessian(hinge.stencil, bending_stiffness_, gather(x, hinge.vertex)), hessian);
}

void Elasticity::find_softening(const Positions& x, std::vector<double>& softening) const {
    softening.assign(static_cast<std::size_t>(x.rows()) + pair_.size(), 0.0);
    for (const Triangle& t : triangle_) {
        const Eigen::Matrix3d local = membrane_softening(t.stencil, stiffness_, gather(x, t.vertex));
        for (int i = 0; i < 3; ++i) {
            softening[t.vertex[i]] += local(i, i);
            softening[t.slot[i]] += local(i, (i + 1) % 3);
        }
    }
}

void Elasticity::add_softened(const std::vector<double>& softening, const Positions& way, Positions& product) const {
    const auto vertices = static_cast<int>(way.rows());
    for (int v = 0; v < vertices; ++v) at(product, v) += softening[v] * at(way, v);
    for (std::size_t k = 0; k < pair_.size(); ++k) {
        const double value = softening[static_cast<std::size_t>(vertices) + k];
        if (value == 0.0) continue;
        at(product, pair_[k].first) += value * at(way, pair_[k].second);
        at(product, pair_[k].second) += value * at(way, pair_[k].first);
    }
    for (const Opposite& pair : opposite_) {
        at(product, pair.first) += pair.value * at(way, pair.second) - std::abs(pair.value) * at(way, pair.first);
        at(product, pair.second) += pair.value * at(way, pair.first) - std::abs(pair.value) * at(way, pair.second);
    }
}

}  // namespace toile::simulate
