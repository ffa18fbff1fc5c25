#include "simulate/xpbd_constraints.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cloth/squeeze.h"
#include "cloth/tension_field.h"

namespace toile::simulate {
namespace {

/// A side of a triangle that is squeezed below this share of its length counts as that long where a step is sized: its
/// strain's gradient vanishes, and Newton's step would throw its ends apart.
constexpr double shortest_stretch = 0.5;
/// A kept force whose direction lags behind by a step is stable up to q/m times its geometric stiffness of 4; this is
/// for one triangle of those around a vertex.
constexpr double largest_lag = 2.0;
/// What a force resists to turning counts this much more than stiffness along it: sweeps find the one implicitly, the
/// other acts a step late.
constexpr double turning_weight = 10.0;
/// A block up to this stiff, as q D G, keeps its force in full, a stiffer one less: sweeps approach the forces of stiff
/// blocks slowly, and kept in full the rest would build up and overshoot, step after step (integral windup).
constexpr double largest_kept_stiffness = 4.0;

double kept_share(double stiffness) {
    return stiffness > largest_kept_stiffness ? largest_kept_stiffness / stiffness : 1.0;
}

template <class Block>
Deformation deformation_of(const Block& block, const Positions& x) {
    Deformation f = Deformation::Zero();
    for (int i = 0; i < 3; ++i) f += x.row(block.vertex[i]).transpose() * block.stencil.corner_gradient.row(i);
    return f;
}

/// Columns: the membrane's force flux through the pattern's u and v, F S with S = (uu, vv, uv).
Deformation flux_of(const Deformation& f, const Eigen::RowVector3d& s) {
    Deformation flux;
    flux.col(0) = s[0] * f.col(0) + s[2] * f.col(1);
    flux.col(1) = s[2] * f.col(0) + s[1] * f.col(1);
    return flux;
}

/// G = J M⁻¹ Jᵀ for the strains (uu, vv, 2uv), from g = Σ (1/m) ∇N ∇Nᵀ.
Eigen::Matrix3d strain_mobility(const Deformation& f, const Eigen::Matrix2d& g) {
    constexpr double least = shortest_stretch * shortest_stretch;
    const double uu = std::max(f.col(0).squaredNorm(), least), vv = std::max(f.col(1).squaredNorm(), least),
                 uv = f.col(0).dot(f.col(1));
    Eigen::Matrix3d mobility;
    mobility(0, 0) = g(0, 0) * uu;
    mobility(1, 1) = g(1, 1) * vv;
    mobility(2, 2) = g(0, 0) * vv + g(1, 1) * uu + 2.0 * g(0, 1) * uv;
    mobility(0, 1) = mobility(1, 0) = g(0, 1) * uv;
    mobility(0, 2) = mobility(2, 0) = g(0, 0) * uv + g(0, 1) * uu;
    mobility(1, 2) = mobility(2, 1) = g(0, 1) * vv + g(1, 1) * uv;
    return mobility;
}

template <class Hinge>
Eigen::RowVector3d curvature_of(const Hinge& hinge, const Positions& x) {
    Eigen::RowVector3d curvature = Eigen::RowVector3d::Zero();
    for (int i = 0; i < 4; ++i) curvature += hinge.weight[i] * x.row(hinge.vertex[i]);
    return curvature;
}

/// The part of v along a direction; all of it where there is none. A hinge's force has no torque where it is along the
/// curvature.
Eigen::RowVector3d along(const Eigen::RowVector3d& direction, const Eigen::RowVector3d& v) {
    const double squared = direction.squaredNorm();
    return squared > 0.0 ? Eigen::RowVector3d(v.dot(direction) / squared * direction) : v;
}

/// Of the symmetric matrix (uu, vv, uv).
double spectral_norm(const Eigen::RowVector3d& s) {
    return std::abs(0.5 * (s[0] + s[1])) + std::hypot(0.5 * (s[0] - s[1]), s[2]);
}

Eigen::Matrix2d weighted_gradients(const XpbdMobility& mobility, const int (&vertex)[3],
                                   const Eigen::Matrix<double, 3, 2>& gradient) {
    Eigen::Matrix2d weighted = Eigen::Matrix2d::Zero();
    for (int i = 0; i < 3; ++i)
        weighted += mobility.inverse_mass[vertex[i]] * gradient.row(i).transpose() * gradient.row(i);
    return weighted;
}

/// Stress and its derivative in the strain (uu, vv, 2uv), per unit of pattern area.
struct Response {
    Eigen::Vector3d stress;
    Eigen::Matrix3d tangent;
};

Response respond(const MembraneStiffness& c, const Deformation& f) {
    const Eigen::Vector3d strain(0.5 * (f.col(0).squaredNorm() - 1.0), 0.5 * (f.col(1).squaredNorm() - 1.0),
                                 f.col(0).dot(f.col(1)));
    if (c.compression == Compression::tension_field) {
        const TensionField field = tension_field(c, strain);
        return {field.stress, field.tangent};
    }
    Response r;
    r.tangent << c.uu, c.uv, 0, c.uv, c.vv, 0, 0, 0, c.shear;
    r.stress = r.tangent * strain;
    return r;
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
        Hinge& hinge = hinge_.emplace_back();
        for (int i = 0; i < 4; ++i) {
            hinge.vertex[i] = v[i];
            hinge.weight[i] = stencil.weight[i];
        }
        hinge.stiffness = options.stiffness * stencil.scale;
    }
}

XpbdForces XpbdConstraints::no_forces() const {
    return {Positions::Zero(static_cast<int>(triangle_.size()), 3),
            Eigen::VectorXd::Zero(static_cast<int>(triangle_.size())),
            PlanePositions::Zero(strain_limit_ ? static_cast<int>(triangle_.size()) : 0, 2),
            Positions::Zero(static_cast<int>(hinge_.size()), 3),
            Eigen::VectorXd::Zero(static_cast<int>(folded_hinge_.size()))};
}

void XpbdConstraints::add_forces(const Positions& start, const XpbdForces& forces, Positions& total) const {
    for (size_t k = 0; k < triangle_.size(); ++k) {
        const Triangle& triangle = triangle_[k];
        const Deformation f = deformation_of(triangle, start);
        Deformation flux = flux_of(f, forces.membrane.row(k));
        if (forces.squeeze[k] != 0.0) flux += forces.squeeze[k] * SqueezeConstraint(stiffness_, f).gradient;
        if (strain_limit_)
            for (int axis = 0; axis < 2; ++axis) flux.col(axis) += forces.limit(k, axis) * f.col(axis).normalized();
        for (int i = 0; i < 3; ++i)
            total.row(triangle.vertex[i]) -= (flux * triangle.stencil.corner_gradient.row(i).transpose()).transpose();
    }
    for (size_t k = 0; k < hinge_.size(); ++k)
        for (int i = 0; i < 4; ++i) total.row(hinge_[k].vertex[i]) -= hinge_[k].weight[i] * forces.bending.row(k);
    for (size_t k = 0; k < folded_hinge_.size(); ++k) {
        const FoldMeasure measure = fold_measure(folded_hinge_[k].stencil, corners_of(folded_hinge_[k], start));
        for (int i = 0; i < 4; ++i)
            total.row(folded_hinge_[k].vertex[i]) -= forces.folding[k] * measure.gradient.segment<3>(3 * i).transpose();
    }
}

void XpbdConstraints::follow_forces(const XpbdMobility& mobility, const Positions& x, const XpbdForces& reached,
                                    XpbdForces& kept) const {
    const double q = mobility.squared_time;
    for (size_t k = 0; k < triangle_.size(); ++k) {
        const Triangle& triangle = triangle_[k];
        const Eigen::Matrix2d g = weighted_gradients(mobility, triangle.vertex, triangle.stencil.corner_gradient);
        const MembraneStiffness& c = stiffness_;
        const double stiff = q * triangle.stencil.area * (c.uu * g(0, 0) + c.vv * g(1, 1) + c.shear * g.trace());
        kept.membrane.row(k) += kept_share(stiff) * (reached.membrane.row(k) - kept.membrane.row(k));
        kept.squeeze[k] += kept_share(stiff) * (reached.squeeze[k] - kept.squeeze[k]);
        for (int axis = 0; strain_limit_ && axis < 2; ++axis) {
            const double slope = 2.0 * std::sqrt(limit_stiffness(triangle) * reached.limit(k, axis));
            kept.limit(k, axis) +=
                kept_share(q * slope * g(axis, axis)) * (reached.limit(k, axis) - kept.limit(k, axis));
        }
    }
    for (size_t k = 0; k < hinge_.size(); ++k) {
        double squared_weight = 0.0;
        for (int i = 0; i < 4; ++i)
            squared_weight += mobility.inverse_mass[hinge_[k].vertex[i]] * hinge_[k].weight[i] * hinge_[k].weight[i];
        kept.bending.row(k) +=
            kept_share(q * hinge_[k].stiffness * squared_weight) * (reached.bending.row(k) - kept.bending.row(k));
    }
    for (size_t k = 0; k < folded_hinge_.size(); ++k) {
        const FoldedHinge& hinge = folded_hinge_[k];
        const FoldMeasure measure = fold_measure(hinge.stencil, corners_of(hinge, x));
        double yield = 0.0;
        for (int i = 0; i < 4; ++i)
            yield += mobility.inverse_mass[hinge.vertex[i]] * measure.gradient.segment<3>(3 * i).squaredNorm();
        const double stiff = q * bending_stiffness_ * yield;
        kept.folding[k] += kept_share(stiff) * (reached.folding[k] - kept.folding[k]);
    }
}

void XpbdConstraints::sweep_triangle(const XpbdMobility& mobility, const Triangle& triangle, const Positions& start,
                                     Eigen::Ref<Eigen::RowVector3d> force, Positions& x) const {
    const double q = mobility.squared_time;
    const auto& gradient = triangle.stencil.corner_gradient;
    const Deformation now = deformation_of(triangle, x), begun = deformation_of(triangle, start);
    const Response response = respond(stiffness_, now);
    const Eigen::Matrix2d weighted = weighted_gradients(mobility, triangle.vertex, gradient);
    const Eigen::Matrix3d tangent = triangle.stencil.area * response.tangent;
    const Eigen::Vector3d lacking = triangle.stencil.area * response.stress - force.transpose();
    const auto change_along = [&](const Deformation& f) -> Eigen::RowVector3d {
        const Eigen::Matrix3d system = Eigen::Matrix3d::Identity() + q * tangent * strain_mobility(f, weighted);
        return (system.inverse() * lacking).transpose();
    };
    const Deformation* direction = &begun;
    Eigen::RowVector3d change = change_along(begun);
    if (lag(mobility, triangle, force + change) > largest_lag) {
        direction = &now;
        change = change_along(now);
    }
    force += change;
    const Deformation flux = flux_of(*direction, change);
    for (int i = 0; i < 3; ++i)
        x.row(triangle.vertex[i]) -=
            q * mobility.inverse_mass[triangle.vertex[i]] * (flux * gradient.row(i).transpose()).transpose();
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

double XpbdConstraints::lag(const XpbdMobility& mobility, const Triangle& triangle, const Eigen::RowVector3d& force) {
    const Eigen::Vector3d slope = triangle.stencil.corner_gradient.rowwise().norm();
    double most = 0.0;
    for (int i = 0; i < 3; ++i) most = std::max(most, mobility.inverse_mass[triangle.vertex[i]] * slope[i]);
    return mobility.squared_time * spectral_norm(force) * most * slope.sum();
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
    for (const Hinge& hinge : hinge_) {
        double sum = 0.0;
        for (double weight : hinge.weight) sum += std::abs(weight);
        for (int i = 0; i < 4; ++i) stiffness[hinge.vertex[i]] += hinge.stiffness * sum * std::abs(hinge.weight[i]);
    }
    for (const FoldedHinge& hinge : folded_hinge_) {
        const FoldMeasure measure = fold_measure(hinge.stencil, corners_of(hinge, x));
        double size[4], sum = 0.0;
        for (int i = 0; i < 4; ++i) sum += size[i] = measure.gradient.segment<3>(3 * i).norm();
        for (int i = 0; i < 4; ++i) stiffness[hinge.vertex[i]] += bending_stiffness_ * sum * size[i];
    }
}

void XpbdConstraints::turn_forces(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces) const {
    for (size_t k = 0; k < triangle_.size(); ++k) {
        const double lagging = lag(mobility, triangle_[k], forces.membrane.row(k));
        if (lagging > largest_lag) forces.membrane.row(k) *= largest_lag / lagging;
        for (int axis = 0; strain_limit_ && axis < 2; ++axis) {
            const double also = lag(mobility, triangle_[k], {forces.limit(k, axis), 0.0, 0.0});
            if (also > largest_lag) forces.limit(k, axis) *= largest_lag / also;
        }
    }
    for (size_t k = 0; k < hinge_.size(); ++k)
        forces.bending.row(k) = along(curvature_of(hinge_[k], start), forces.bending.row(k));
}

void XpbdConstraints::sweep_hinge(const XpbdMobility& mobility, const Hinge& hinge, const Positions& start,
                                  Eigen::Ref<Eigen::RowVector3d> force, Positions& x) {
    double squared_weight = 0.0;
    for (int i = 0; i < 4; ++i)
        squared_weight += mobility.inverse_mass[hinge.vertex[i]] * hinge.weight[i] * hinge.weight[i];
    const double q = mobility.squared_time;
    const Eigen::RowVector3d lacking = hinge.stiffness * curvature_of(hinge, x) - force;
    const Eigen::RowVector3d change =
        along(curvature_of(hinge, start), lacking) / (1.0 + q * hinge.stiffness * squared_weight);
    force += change;
    for (int i = 0; i < 4; ++i)
        x.row(hinge.vertex[i]) -= q * mobility.inverse_mass[hinge.vertex[i]] * hinge.weight[i] * change;
}

void XpbdConstraints::sweep(const XpbdMobility& mobility, const Positions& start, XpbdForces& forces,
                            Positions& x) const {
    for (size_t k = 0; k < triangle_.size(); ++k) {
        sweep_triangle(mobility, triangle_[k], start, forces.membrane.row(k), x);
        if (stiffness_.compression == Compression::full)
            sweep_squeeze(mobility, triangle_[k], start, forces.squeeze[k], x);
        if (strain_limit_) sweep_limit(mobility, triangle_[k], start, forces.limit.row(k), x);
    }
    for (size_t k = 0; k < hinge_.size(); ++k) sweep_hinge(mobility, hinge_[k], start, forces.bending.row(k), x);
    for (size_t k = 0; k < folded_hinge_.size(); ++k) sweep_folded(mobility, folded_hinge_[k], forces.folding[k], x);
}

}  // namespace toile::simulate
