#include "simulate/xpbd_constraints.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cloth/squeeze.h"
#include "cloth/tension_field.h"

namespace toile::simulate {
namespace {

/// What a force resists to turning counts this much more than stiffness along it: sweeps find the one implicitly, the
/// other acts a step late.
constexpr double turning_weight = 10.0;
template <class Block>
Deformation deformation_of(const Block& block, const Positions& x) {
    Deformation f = Deformation::Zero();
    for (int i = 0; i < 3; ++i) f += x.row(block.vertex[i]).transpose() * block.stencil.corner_gradient.row(i);
    return f;
}

/// Of the symmetric matrix (uu, vv, uv).
double spectral_norm(const Eigen::RowVector3d& s) {
    return std::abs(0.5 * (s[0] + s[1])) + std::sqrt(0.25 * (s[0] - s[1]) * (s[0] - s[1]) + s[2] * s[2]);
}

Eigen::Matrix2d weighted_gradients(const XpbdMobility& mobility, const int (&vertex)[3],
                                   const Eigen::Matrix<double, 3, 2>& gradient) {
    Eigen::Matrix2d weighted = Eigen::Matrix2d::Zero();
    for (int i = 0; i < 3; ++i)
        weighted += mobility.inverse_mass[vertex[i]] * gradient.row(i).transpose() * gradient.row(i);
    return weighted;
}

/// C = √(2ψ) of cloth/squeeze.h and ∂C/∂F; both zero where nothing is squeezed.
struct SqueezeConstraint {
    double value = 0.0;
    Deformation gradient = Deformation::Zero();

    SqueezeConstraint(const MembraneStiffness& c, const Deformation& f) {
        if (c.compression != Compression::full || !Squeeze::acts(f)) return;
        const Squeeze squeeze(f, Squeeze::ratio * std::max(c.uu, c.vv));
        if (!(squeeze.energy() > 0.0)) return;
        value = std::sqrt(2.0 * squeeze.energy());
        gradient = squeeze.stress() / value;
    }
    bool acts() const { return value > 0.0; }
};

/// One number's constraint, of energy ½ `stiffness` C²: its force becomes stiffness times C, and the vertices move
/// along the columns of C's gradient.
template <int N>
void mend(const XpbdMobility& mobility, const int (&vertex)[N], double stiffness, double value,
          const Eigen::Matrix<double, 3, N>& gradient, double& force, Positions& x) {
    double yield = 0.0;
    for (int i = 0; i < N; ++i) yield += mobility.inverse_mass[vertex[i]] * gradient.col(i).squaredNorm();
    const double q = mobility.squared_time;
    const double change = (stiffness * value - force) / (1.0 + q * stiffness * yield);
    force += change;
    for (int i = 0; i < N; ++i)
        x.row(vertex[i]) -= q * change * mobility.inverse_mass[vertex[i]] * gradient.col(i).transpose();
}

/// u + c u² = free, where that is positive: what is left of it once a force that grows with u² has acted.
double left_beyond(double free, double c) {
    return free > 0.0 ? 2.0 * free / (1.0 + std::sqrt(1.0 + 4.0 * c * free)) : 0.0;
}

template <class Hinge>
HingePositions corners_of(const Hinge& hinge, const Positions& x) {
    HingePositions corners;
    for (int i = 0; i < 4; ++i) corners.col(i) = x.row(hinge.vertex[i]).transpose();
    return corners;
}

}  // namespace

XpbdConstraints::XpbdConstraints(const ClothMesh& mesh, const Topology& topology, const MembraneOptions& membrane,
                                 const std::optional<BendingOptions>& bending,
                                 const std::optional<StrainLimit>& strain_limit)
    : stiffness_(MembraneStiffness::from_moduli(membrane.weft_stiffness, membrane.warp_stiffness,
                                                membrane.shear_stiffness, membrane.poisson_ratio,
                                                membrane.compression)),
      membrane_(mesh, stiffness_),
      strain_limit_(strain_limit) {
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        const auto t = mesh.triangle.row(f);
        triangle_.push_back({{t[0], t[1], t[2]}, membrane_stencil(mesh, f)});
    }
    if (bending) add_hinges(mesh, topology, *bending);
}

void XpbdConstraints::add_hinges(const ClothMesh& mesh, const Topology& topology, const BendingOptions& options) {
    bending_stiffness_ = options.stiffness;
    const auto hinges = build_hinges(topology, mesh.triangle);
    int h = 0;
    for (int e = 0; e < topology.edge.rows(); ++e) {
        if (topology.edge_triangle(e, 1) < 0) continue;
        const auto v = hinges.row(h++);
        const int first = topology.edge_triangle(e, 0), second = topology.edge_triangle(e, 1);
        if (options.rest == BendingRest::start) {
            folded_hinge_.push_back({{v[0], v[1], v[2], v[3]}, fold_stencil(mesh, v.transpose(), first, second)});
            continue;
        }
        const BendingStencil stencil = bending_stencil(mesh, v.transpose(), first, second);
        bending_.add({v[0], v[1], v[2], v[3]},
                     {stencil.weight[0], stencil.weight[1], stencil.weight[2], stencil.weight[3]},
                     options.stiffness * stencil.scale);
    }
    bending_.finish();
}

XpbdForces XpbdConstraints::no_forces() const {
    return {Positions::Zero(static_cast<int>(triangle_.size()), 3),
            Eigen::VectorXd::Zero(static_cast<int>(triangle_.size())),
            PlanePositions::Zero(strain_limit_ ? static_cast<int>(triangle_.size()) : 0, 2),
            Positions::Zero(bending_.count(), 3), Eigen::VectorXd::Zero(static_cast<int>(folded_hinge_.size()))};
}

void XpbdConstraints::begin(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces,
                            Positions& total) const {
    membrane_.begin(mobility, start, forces.membrane, total);
    bending_.begin(start, forces.bending, total);
    const auto push = [&](const Triangle& triangle, const Deformation& flux) {
        for (int i = 0; i < 3; ++i)
            total.row(triangle.vertex[i]) -= (flux * triangle.stencil.corner_gradient.row(i).transpose()).transpose();
    };
    for (size_t k = 0; k < triangle_.size(); ++k) {
        const Triangle& triangle = triangle_[k];
        if (forces.squeeze[k] != 0.0)
            push(triangle, forces.squeeze[k] * SqueezeConstraint(stiffness_, deformation_of(triangle, start)).gradient);
        if (!strain_limit_) continue;
        Deformation flux = deformation_of(triangle, start).colwise().normalized();
        for (int axis = 0; axis < 2; ++axis) {
            const double lagging = lag(mobility, triangle, forces.limit(k, axis));
            if (lagging > largest_lag) forces.limit(k, axis) *= largest_lag / lagging;
            flux.col(axis) *= forces.limit(k, axis);
        }
        push(triangle, flux);
    }
    for (size_t k = 0; k < folded_hinge_.size(); ++k) {
        const FoldMeasure measure = fold_measure(folded_hinge_[k].stencil, corners_of(folded_hinge_[k], start));
        for (int i = 0; i < 4; ++i)
            total.row(folded_hinge_[k].vertex[i]) -= forces.folding[k] * measure.gradient.segment<3>(3 * i).transpose();
    }
}

void XpbdConstraints::follow_forces(const XpbdMobility& mobility, const Positions& x, const XpbdForces& reached,
                                    XpbdForces& kept) const {
    membrane_.follow(mobility, reached.membrane, kept.membrane);
    bending_.follow(mobility, reached.bending, kept.bending);
    follow_scalars(mobility, x, reached, kept);
}

void XpbdConstraints::follow_scalars(const XpbdMobility& mobility, const Positions& x, const XpbdForces& reached,
                                     XpbdForces& kept) const {
    const double q = mobility.squared_time;
    for (size_t k = 0; k < triangle_.size(); ++k) {
        if (reached.squeeze[k] == 0.0 && kept.squeeze[k] == 0.0 && !strain_limit_) continue;
        const Triangle& triangle = triangle_[k];
        const Eigen::Matrix2d g = weighted_gradients(mobility, triangle.vertex, triangle.stencil.corner_gradient);
        const double stiff = q * triangle.stencil.area * std::max(stiffness_.uu, stiffness_.vv) * g.trace();
        kept.squeeze[k] += kept_share(stiff) * (reached.squeeze[k] - kept.squeeze[k]);
        for (int axis = 0; strain_limit_ && axis < 2; ++axis) {
            const double limit_stiff = q * limit_slope(triangle, reached.limit(k, axis)) * g(axis, axis);
            kept.limit(k, axis) += kept_share(limit_stiff) * (reached.limit(k, axis) - kept.limit(k, axis));
        }
    }
    for (size_t k = 0; k < folded_hinge_.size(); ++k) {
        const FoldedHinge& hinge = folded_hinge_[k];
        const FoldMeasure measure = fold_measure(hinge.stencil, corners_of(hinge, x));
        double yield = 0.0;
        for (int i = 0; i < 4; ++i)
            yield += mobility.inverse_mass[hinge.vertex[i]] * measure.gradient.segment<3>(3 * i).squaredNorm();
        kept.folding[k] += kept_share(q * bending_stiffness_ * yield) * (reached.folding[k] - kept.folding[k]);
    }
}

void XpbdConstraints::sweep_squeeze(const XpbdMobility& mobility, const Triangle& triangle, const Positions& start,
                                    double& force, Positions& x) const {
    const SqueezeConstraint now(stiffness_, deformation_of(triangle, x));
    if (!now.acts() && force == 0.0) return;
    const SqueezeConstraint begun(stiffness_, deformation_of(triangle, start));
    const Deformation& direction = begun.acts() ? begun.gradient : now.gradient;
    const Eigen::Matrix3d gradient = direction * triangle.stencil.corner_gradient.transpose();
    mend<3>(mobility, triangle.vertex, triangle.stencil.area, now.value, gradient, force, x);
}

void XpbdConstraints::sweep_limit(const XpbdMobility& mobility, const Triangle& triangle, const Positions& start,
                                  Eigen::Ref<Eigen::RowVector2d> force, Positions& x) const {
    const auto& gradient = triangle.stencil.corner_gradient;
    const double q = mobility.squared_time, stiffness = limit_stiffness(triangle);
    for (int axis = 0; axis < 2; ++axis) {
        const double length = (deformation_of(triangle, x).col(axis)).norm();
        const double beyond = length - (axis == 0 ? strain_limit_->u : strain_limit_->v);
        if (!(beyond > 0.0) && force[axis] == 0.0) continue;
        const Eigen::Vector3d begun = deformation_of(triangle, start).col(axis);
        double yield = 0.0;
        for (int i = 0; i < 3; ++i)
            yield += q * mobility.inverse_mass[triangle.vertex[i]] * gradient(i, axis) * gradient(i, axis);
        const double left = left_beyond(beyond + yield * force[axis], yield * stiffness);
        const double change = stiffness * left * left - force[axis];
        force[axis] += change;
        const Eigen::RowVector3d along = begun.normalized().transpose();
        for (int i = 0; i < 3; ++i)
            x.row(triangle.vertex[i]) -=
                q * mobility.inverse_mass[triangle.vertex[i]] * change * gradient(i, axis) * along;
    }
}

void XpbdConstraints::sweep_folded(const XpbdMobility& mobility, const FoldedHinge& hinge, double& force,
                                   Positions& x) const {
    const FoldMeasure measure = fold_measure(hinge.stencil, corners_of(hinge, x));
    const Eigen::Map<const HingePositions> gradient(measure.gradient.data());
    mend<4>(mobility, hinge.vertex, bending_stiffness_, measure.value, gradient, force, x);
}

double XpbdConstraints::lag(const XpbdMobility& mobility, const Triangle& triangle, double stress) {
    const Eigen::Vector3d slope = triangle.stencil.corner_gradient.rowwise().norm();
    double most = 0.0;
    for (int i = 0; i < 3; ++i) most = std::max(most, mobility.inverse_mass[triangle.vertex[i]] * slope[i]);
    return mobility.squared_time * stress * most * slope.sum();
}

void XpbdConstraints::add_stiffness(const Positions& x, const XpbdForces& forces, Eigen::VectorXd& stiffness) const {
    const double stiffest = std::max({stiffness_.uu, stiffness_.vv, stiffness_.shear});
    for (size_t k = 0; k < triangle_.size(); ++k) {
        const Triangle& triangle = triangle_[k];
        const Eigen::Vector3d slope = triangle.stencil.corner_gradient.rowwise().norm();
        double both = triangle.stencil.area * stiffest + turning_weight * spectral_norm(forces.membrane.row(k));
        if (strain_limit_) {
            const Deformation f = deformation_of(triangle, x);
            const double beyond = std::max(f.col(0).norm() - strain_limit_->u, f.col(1).norm() - strain_limit_->v);
            both +=
                2.0 * limit_stiffness(triangle) * std::max(0.0, beyond) + turning_weight * forces.limit.row(k).sum();
        }
        for (int i = 0; i < 3; ++i) stiffness[triangle.vertex[i]] += both * slope.sum() * slope[i];
    }
    bending_.add_stiffness(stiffness);
    for (const FoldedHinge& hinge : folded_hinge_) {
        const FoldMeasure measure = fold_measure(hinge.stencil, corners_of(hinge, x));
        double size[4], sum = 0.0;
        for (int i = 0; i < 4; ++i) sum += size[i] = measure.gradient.segment<3>(3 * i).norm();
        for (int i = 0; i < 4; ++i) stiffness[hinge.vertex[i]] += bending_stiffness_ * sum * size[i];
    }
}

void XpbdConstraints::sweep(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces,
                            Positions& x) const {
    const auto squeezed = [&](int k) { sweep_squeeze(mobility, triangle_[k], start, forces.squeeze[k], x); };
    const bool full = stiffness_.compression == Compression::full;
    membrane_.sweep(mobility, {start, forces.membrane, x, full ? std::function<void(int)>(squeezed) : nullptr,
                               forces.squeeze.data()});
    for (size_t k = 0; strain_limit_ && k < triangle_.size(); ++k)
        sweep_limit(mobility, triangle_[k], start, forces.limit.row(k), x);
    bending_.sweep(mobility, start, forces.bending, x);
    for (size_t k = 0; k < folded_hinge_.size(); ++k) sweep_folded(mobility, folded_hinge_[k], forces.folding[k], x);
}

}  // namespace toile::simulate
