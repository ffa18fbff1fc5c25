#include "cloth/tension_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/membrane.h"

namespace toile {
namespace {

/// The strain in coordinates (p, q, e) in which ψ = ½ Σ w_i (·)_i² and W ⪰ 0 is the cone p ≥ |(q, e)|: the pattern's
/// axes are scaled by d_u = c_uu^¼, d_v = c_vv^¼, which keeps the cone and makes warp and weft alike, then p = (a +
/// b)/2, q = (a − b)/2 of the scaled ε_uu, ε_vv, and e the scaled ε_uv.
struct Cone {
    Eigen::Matrix3d to;      // from (ε_uu, ε_vv, 2 ε_uv)
    Eigen::Vector3d weight;  // w

    explicit Cone(const MembraneStiffness& c) {
        const double u = std::sqrt(c.uu), v = std::sqrt(c.vv), both = u * v;
        to << 0.5 * u, 0.5 * v, 0, 0.5 * u, -0.5 * v, 0, 0, 0, 0.5 * std::sqrt(both);
        const double coupling = c.uv / both;
        weight << 2.0 * (1.0 + coupling), 2.0 * (1.0 - coupling), 4.0 * c.shear / both;
    }
};

/// The τ of a wrinkled state: root of |p| / |1/w₀ − τ| = |(q / (1/w₁ + τ), e / (1/w₂ + τ))|, 0 < τ; below 1/w₀ where
/// p > 0 and above it where p < 0. The two sides cross once there: found by Newton's method on the difference of their
/// logarithms, kept in a bracket.
double wrinkle_parameter(const Eigen::Vector3d& z, const Eigen::Vector3d& w) {
    const double i0 = 1.0 / w[0], i1 = 1.0 / w[1], i2 = 1.0 / w[2];
    if (z[0] == 0.0) return i0;
    double low = z[0] > 0.0 ? 0.0 : i0, high = z[0] > 0.0 ? i0 : std::numeric_limits<double>::infinity();
    double tau = z[0] > 0.0 ? 0.5 * i0 : 2.0 * i0 + std::max(i1, i2);
    for (int iteration = 0; iteration < 100; ++iteration) {
        const double s0 = z[0] / (i0 - tau), s1 = z[1] / (i1 + tau), s2 = z[2] / (i2 + tau);
        const double left = s0 * s0, right = s1 * s1 + s2 * s2;
        const double slope_left = 2.0 * left / (i0 - tau);
        const double slope_right = -2.0 * (s1 * s1 / (i1 + tau) + s2 * s2 / (i2 + tau));
        // left − right rises with τ where p > 0 and falls towards its root where p < 0.
        const bool beyond = z[0] > 0.0 ? left > right : left < right;
        (beyond ? high : low) = tau;
        double next = tau - std::log(left / right) / (slope_left / left - slope_right / right);
        if (!(next > low && next < high)) next = std::isinf(high) ? 2.0 * tau : 0.5 * (low + high);
        const double change = std::abs(next - tau);
        tau = next;
        if (change <= 1e-14 * tau) break;
    }
    return tau;
}

}  // namespace

TensionField tension_field(const MembraneStiffness& stiffness, const Eigen::Vector3d& green) {
    const Cone cone(stiffness);
    const Eigen::Vector3d z = cone.to * green, w = cone.weight;
    const Eigen::Vector3d taut = w.cwiseProduct(z);
    const auto respond = [&](const Eigen::Vector3d& stress, const Eigen::Matrix3d& tangent) {
        // ½ Σ w (s / w)²: the energy of the strain that is left after wrinkling.
        TensionField field;
        field.energy = 0.5 * stress.dot(stress.cwiseQuotient(w));
        field.stress = cone.to.transpose() * stress;
        field.tangent = cone.to.transpose() * tangent * cone.to;
        return field;
    };
    if (taut[0] >= std::sqrt(taut[1] * taut[1] + taut[2] * taut[2])) return respond(taut, w.asDiagonal());
    if (-z[0] >= std::sqrt(z[1] * z[1] + z[2] * z[2])) return respond(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero());
    const double tau = wrinkle_parameter(z, w);
    const Eigen::Vector3d inverse(1.0 / w[0] - tau, 1.0 / w[1] + tau, 1.0 / w[2] + tau);
    Eigen::Vector3d s = z.cwiseQuotient(inverse);
    s[0] = std::sqrt(s[1] * s[1] + s[2] * s[2]);
    // With M = diag(inverse), M s = z and j = (−s₀, s₁, s₂): M ds + j dτ = dz and j·ds = 0.
    const Eigen::Vector3d j(-s[0], s[1], s[2]), mj = Eigen::Vector3d(0, j[1] / inverse[1], j[2] / inverse[2]);
    // The first row is written so that it stays finite where inverse₀ = 0, that is where p = 0.
    const double rest = mj[1] * j[1] + mj[2] * j[2];  // Σ j²/m without the first
    const double first = j[0] * j[0], whole = first + rest * inverse[0];
    Eigen::Matrix3d tangent;
    tangent(0, 0) = rest / whole;
    for (int k = 1; k < 3; ++k) tangent(0, k) = tangent(k, 0) = -j[0] * mj[k] / whole;
    for (int k = 1; k < 3; ++k)
        for (int l = 1; l < 3; ++l)
            tangent(k, l) = (k == l ? 1.0 / inverse[k] : 0.0) - mj[k] * mj[l] * inverse[0] / whole;
    return respond(s, tangent);
}

}  // namespace toile
