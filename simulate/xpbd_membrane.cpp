#include "simulate/xpbd_membrane.h"

#include <cmath>

#include "cloth/squeeze.h"
#include "cloth/tension_field.h"

namespace toile::simulate {
namespace {

/// A side of a triangle that is squeezed below this share of its length counts as that long where a step is sized: its
/// strain's gradient vanishes, and Newton's step would throw its ends apart.
constexpr double shortest_stretch = 0.5;

constexpr int gradient_u = 0, gradient_v = 3, slope_at = 6, area_at = 9, constant_count = 10;
constexpr int stress_at = 0, tangent_at = 3, response_count = 9;

[[gnu::always_inline]] inline Lane8 constant(const double* constants, int which) {
    return load_lanes<8>(constants + which * xpbd_lanes);
}

/// [f_u f_v] of eight triangles.
struct Deformations {
    Lane8 u[3], v[3];
};

[[gnu::always_inline]] inline Deformations deform(const double* constants, const Lane8 (&x)[3][3]) {
    Deformations f;
    for (int c = 0; c < 3; ++c) {
        f.u[c] = f.v[c] = lane_broadcast<8>(0.0);
        for (int i = 0; i < 3; ++i) {
            f.u[c] += constant(constants, gradient_u + i) * x[i][c];
            f.v[c] += constant(constants, gradient_v + i) * x[i][c];
        }
    }
    return f;
}

[[gnu::always_inline]] inline void gather_corners(const XpbdBatch<3>& batch, const double* x, Lane8 (&corner)[3][3]) {
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) corner[i][c] = gather_lanes(x, 3, batch.vertex[i], c);
}

[[gnu::always_inline]] inline Lane8 dot(const Lane8 (&a)[3], const Lane8 (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Force on corner i from the stresses s = (uu, vv, uv) times area: component c of F S ∇N.
[[gnu::always_inline]] inline Lane8 corner_force(const double* constants, const Deformations& f, const Lane8 (&s)[3],
                                                 int i, int c) {
    const Lane8 flux_u = s[0] * f.u[c] + s[2] * f.v[c], flux_v = s[2] * f.u[c] + s[1] * f.v[c];
    return flux_u * constant(constants, gradient_u + i) + flux_v * constant(constants, gradient_v + i);
}

/// q times the spectral norm of s = (uu, vv, uv) times the stiffness against turning that it is for the lightest
/// corner.
[[gnu::always_inline]] inline Lane8 lag(const double* constants, double q, const Lane8 (&inverse_mass)[3],
                                        const Lane8 (&s)[3]) {
    const Lane8 half = 0.5 * (s[0] - s[1]);
    const Lane8 norm = lane_abs(0.5 * (s[0] + s[1])) + lane_sqrt(half * half + s[2] * s[2]);
    Lane8 most = lane_broadcast<8>(0.0), sum = most;
    for (int i = 0; i < 3; ++i) {
        const Lane8 slope = constant(constants, slope_at + i);
        most = lane_max(most, inverse_mass[i] * slope);
        sum += slope;
    }
    return q * norm * most * sum;
}

/// Σ (1/m) ∇N ∇Nᵀ: uu, vv, uv.
struct WeightedGradients {
    Lane8 uu, vv, uv;
};

[[gnu::always_inline]] inline WeightedGradients weigh(const double* constants, const Lane8 (&inverse_mass)[3]) {
    WeightedGradients g;
    g.uu = g.vv = g.uv = lane_broadcast<8>(0.0);
    for (int i = 0; i < 3; ++i) {
        const Lane8 u = constant(constants, gradient_u + i), v = constant(constants, gradient_v + i);
        g.uu += inverse_mass[i] * u * u;
        g.vv += inverse_mass[i] * v * v;
        g.uv += inverse_mass[i] * u * v;
    }
    return g;
}

/// Symmetric: (0,0), (1,1), (2,2), (0,1), (0,2), (1,2).
struct Symmetric {
    Lane8 a, b, c, ab, ac, bc;
};

/// G = J M⁻¹ Jᵀ for the strains (uu, vv, 2uv).
[[gnu::always_inline]] inline Symmetric strain_mobility(const Deformations& f, const WeightedGradients& g) {
    const Lane8 least = lane_broadcast<8>(shortest_stretch * shortest_stretch);
    const Lane8 uu = lane_max(dot(f.u, f.u), least), vv = lane_max(dot(f.v, f.v), least), uv = dot(f.u, f.v);
    return {g.uu * uu,
            g.vv * vv,
            g.uu * vv + g.vv * uu + 2.0 * g.uv * uv,
            g.uv * uv,
            g.uu * uv + g.uv * uu,
            g.uv * vv + g.vv * uv};
}

/// (1 + T G)⁻¹ r, T being the tangent times q and area.
[[gnu::always_inline]] inline void solve(const Symmetric& t, const Symmetric& g, const Lane8 (&r)[3], Lane8 (&s)[3]) {
    const Lane8 m00 = 1.0 + t.a * g.a + t.ab * g.ab + t.ac * g.ac, m01 = t.a * g.ab + t.ab * g.b + t.ac * g.bc,
                m02 = t.a * g.ac + t.ab * g.bc + t.ac * g.c;
    const Lane8 m10 = t.ab * g.a + t.b * g.ab + t.bc * g.ac, m11 = 1.0 + t.ab * g.ab + t.b * g.b + t.bc * g.bc,
                m12 = t.ab * g.ac + t.b * g.bc + t.bc * g.c;
    const Lane8 m20 = t.ac * g.a + t.bc * g.ab + t.c * g.ac, m21 = t.ac * g.ab + t.bc * g.b + t.c * g.bc,
                m22 = 1.0 + t.ac * g.ac + t.bc * g.bc + t.c * g.c;
    const Lane8 c00 = m11 * m22 - m12 * m21, c01 = m12 * m20 - m10 * m22, c02 = m10 * m21 - m11 * m20;
    const Lane8 inverse = 1.0 / (m00 * c00 + m01 * c01 + m02 * c02);
    s[0] = inverse * (c00 * r[0] + (m02 * m21 - m01 * m22) * r[1] + (m01 * m12 - m02 * m11) * r[2]);
    s[1] = inverse * (c01 * r[0] + (m00 * m22 - m02 * m20) * r[1] + (m02 * m10 - m00 * m12) * r[2]);
    s[2] = inverse * (c02 * r[0] + (m01 * m20 - m00 * m21) * r[1] + (m00 * m11 - m01 * m10) * r[2]);
}

/// Stress and its derivative in the strain (uu, vv, 2uv), per unit of pattern area.
struct Responses {
    Lane8 stress[3];
    Symmetric tangent;
};

[[gnu::always_inline]] inline Responses quadratic_response(const MembraneStiffness& k, const Deformations& f) {
    const Lane8 zero = lane_broadcast<8>(0.0);
    const Lane8 uu = 0.5 * (dot(f.u, f.u) - 1.0), vv = 0.5 * (dot(f.v, f.v) - 1.0), uv = dot(f.u, f.v);
    return {{k.uu * uu + k.uv * vv, k.uv * uu + k.vv * vv, k.shear * uv},
            {zero + k.uu, zero + k.vv, zero + k.shear, zero + k.uv, zero, zero}};
}

[[gnu::always_inline]] inline Responses given_response(const double* r) {
    const auto at = [&](int which) { return load_lanes<8>(r + which * xpbd_lanes); };
    return {{at(stress_at), at(stress_at + 1), at(stress_at + 2)},
            {at(tangent_at), at(tangent_at + 1), at(tangent_at + 2), at(tangent_at + 3), at(tangent_at + 4),
             at(tangent_at + 5)}};
}

[[gnu::always_inline]] inline LaneMask8 is_squeezed(const Deformations& f) {
    const Lane8 square = lane_broadcast<8>(Squeeze::onset * Squeeze::onset), zero = lane_broadcast<8>(0.0);
    const Lane8 a = dot(f.u, f.u) - square, b = dot(f.v, f.v) - square, c = dot(f.u, f.v);
    return lane_less(a + b, zero) | lane_less(a * b, c * c);
}

struct SweepArrays {
    double q;
    const double *inverse_mass, *start;
    double *force, *x;
};

/// Bits tell which lanes are squeezed where the sweep finds them.
[[gnu::always_inline]] inline unsigned sweep_one(const MembraneStiffness& k, const XpbdBatch<3>& batch,
                                                 const double* constants, const double* response,
                                                 const SweepArrays& a) {
    Lane8 x[3][3], x0[3][3], inverse_mass[3], s[3], change[3], lacking[3], whole[3];
    gather_corners(batch, a.x, x);
    gather_corners(batch, a.start, x0);
    for (int i = 0; i < 3; ++i) {
        inverse_mass[i] = gather_lanes(a.inverse_mass, 1, batch.vertex[i], 0);
        s[i] = gather_lanes(a.force, 3, batch.item, i);
    }
    const Deformations now = deform(constants, x);
    Deformations direction = deform(constants, x0);
    const Responses r = response ? given_response(response) : quadratic_response(k, now);
    const Lane8 area = constant(constants, area_at), scale = a.q * area;
    const Symmetric tangent{scale * r.tangent.a,  scale * r.tangent.b,  scale * r.tangent.c,
                            scale * r.tangent.ab, scale * r.tangent.ac, scale * r.tangent.bc};
    const WeightedGradients g = weigh(constants, inverse_mass);
    for (int i = 0; i < 3; ++i) lacking[i] = area * r.stress[i] - s[i];
    solve(tangent, strain_mobility(direction, g), lacking, change);
    for (int i = 0; i < 3; ++i) whole[i] = s[i] + change[i];
    const LaneMask8 lagging = lane_less(lane_broadcast<8>(largest_lag), lag(constants, a.q, inverse_mass, whole));
    if (lane_bits(lagging)) {
        Lane8 other[3];
        solve(tangent, strain_mobility(now, g), lacking, other);
        for (int i = 0; i < 3; ++i) {
            change[i] = lane_select(lagging, other[i], change[i]);
            direction.u[i] = lane_select(lagging, now.u[i], direction.u[i]);
            direction.v[i] = lane_select(lagging, now.v[i], direction.v[i]);
        }
    }
    for (int i = 0; i < 3; ++i) {
        scatter_lanes(s[i] + change[i], a.force, 3, batch.item, i, batch.count);
        const Lane8 move = a.q * inverse_mass[i];
        for (int c = 0; c < 3; ++c)
            scatter_lanes(x[i][c] - move * corner_force(constants, direction, change, i, c), a.x, 3, batch.vertex[i], c,
                          batch.count);
    }
    return lane_bits(is_squeezed(now));
}

/// Returns the batch after the first one with a squeezed triangle, or with one marked in `also` (if that is not null);
/// `squeezed` are its bits.
TOILE_LANE_KERNEL int sweep_batches(const MembraneStiffness& k, const XpbdBatch<3>* batches, int first, int last,
                                    const double* constants, const double* response, const SweepArrays& arrays,
                                    const double* also, unsigned* squeezed) {
    for (int b = first; b < last; ++b) {
        const XpbdBatch<3>& batch = batches[b];
        unsigned bits = sweep_one(k, batch, constants + b * constant_count * xpbd_lanes, response, arrays);
        if (!also) continue;
        for (int lane = 0; lane < xpbd_lanes; ++lane) bits |= also[batch.item[lane]] != 0.0 ? 1u << lane : 0u;
        bits &= (1u << batch.count) - 1u;
        if (!bits) continue;
        *squeezed = bits;
        return b + 1;
    }
    *squeezed = 0;
    return last;
}

TOILE_LANE_KERNEL void begin_batches(const XpbdBatch<3>* batch, int count, const double* constants, double q,
                                     const double* inverse_mass, const double* start, double* force, double* total) {
    for (int b = 0; b < count; ++b, ++batch, constants += constant_count * xpbd_lanes) {
        Lane8 x[3][3], weight[3], s[3];
        gather_corners(*batch, start, x);
        for (int i = 0; i < 3; ++i) {
            weight[i] = gather_lanes(inverse_mass, 1, batch->vertex[i], 0);
            s[i] = gather_lanes(force, 3, batch->item, i);
        }
        const Lane8 share = largest_lag / lane_max(lag(constants, q, weight, s), lane_broadcast<8>(largest_lag));
        for (int i = 0; i < 3; ++i) {
            s[i] *= share;
            scatter_lanes(s[i], force, 3, batch->item, i, batch->count);
        }
        const Deformations f = deform(constants, x);
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c)
                scatter_add_lanes(-corner_force(constants, f, s, i, c), total, 3, batch->vertex[i], c, batch->count);
    }
}

TOILE_LANE_KERNEL void follow_batches(const MembraneStiffness& k, const XpbdBatch<3>* batch, int count,
                                      const double* constants, double q, const double* inverse_mass,
                                      const double* reached, double* kept) {
    for (int b = 0; b < count; ++b, ++batch, constants += constant_count * xpbd_lanes) {
        Lane8 weight[3];
        for (int i = 0; i < 3; ++i) weight[i] = gather_lanes(inverse_mass, 1, batch->vertex[i], 0);
        const WeightedGradients g = weigh(constants, weight);
        const Lane8 stiff = q * constant(constants, area_at) * (k.uu * g.uu + k.vv * g.vv + k.shear * (g.uu + g.vv));
        const Lane8 share = largest_kept_stiffness / lane_max(stiff, lane_broadcast<8>(largest_kept_stiffness));
        for (int i = 0; i < 3; ++i) {
            const Lane8 before = gather_lanes(kept, 3, batch->item, i);
            const Lane8 after = before + share * (gather_lanes(reached, 3, batch->item, i) - before);
            scatter_lanes(after, kept, 3, batch->item, i, batch->count);
        }
    }
}

}  // namespace

XpbdMembrane::XpbdMembrane(const ClothMesh& mesh, const MembraneStiffness& stiffness) : stiffness_(stiffness) {
    std::vector<std::array<int, 3>> triangles;
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        triangles.push_back({mesh.triangle(f, 0), mesh.triangle(f, 1), mesh.triangle(f, 2)});
        stencil_.push_back(membrane_stencil(mesh, f));
    }
    batch_ = make_batches<3>(triangles);
    constants_ = LaneArray(batch_.size() * constant_count * xpbd_lanes);
    for (size_t b = 0; b < batch_.size(); ++b) {
        double* constants = constants_.data() + b * constant_count * xpbd_lanes;
        for (int lane = 0; lane < xpbd_lanes; ++lane) {
            const MembraneStencil& stencil = stencil_[batch_[b].item[lane]];
            for (int i = 0; i < 3; ++i) {
                constants[(gradient_u + i) * xpbd_lanes + lane] = stencil.corner_gradient(i, 0);
                constants[(gradient_v + i) * xpbd_lanes + lane] = stencil.corner_gradient(i, 1);
                constants[(slope_at + i) * xpbd_lanes + lane] = stencil.corner_gradient.row(i).norm();
            }
            constants[area_at * xpbd_lanes + lane] = stencil.area;
        }
    }
}

void XpbdMembrane::begin(const XpbdMobility& mobility, const Positions& start, Positions& force,
                         Positions& total) const {
    begin_batches(batch_.data(), static_cast<int>(batch_.size()), constants_.data(), mobility.squared_time,
                  mobility.inverse_mass.data(), start.data(), force.data(), total.data());
}

void XpbdMembrane::respond(const XpbdBatch<3>& batch, const Positions& x, double* response) const {
    for (int lane = 0; lane < xpbd_lanes; ++lane) {
        Deformation f = Deformation::Zero();
        const Deformation& gradient = stencil_[batch.item[lane]].corner_gradient;
        for (int i = 0; i < 3; ++i) f += x.row(batch.vertex[i][lane]).transpose() * gradient.row(i);
        const TensionField field = tension_field(
            stiffness_,
            {0.5 * (f.col(0).squaredNorm() - 1.0), 0.5 * (f.col(1).squaredNorm() - 1.0), f.col(0).dot(f.col(1))});
        const auto set = [&](int which, double value) { response[which * xpbd_lanes + lane] = value; };
        for (int i = 0; i < 3; ++i) {
            set(stress_at + i, field.stress[i]);
            set(tangent_at + i, field.tangent(i, i));
        }
        set(tangent_at + 3, field.tangent(0, 1));
        set(tangent_at + 4, field.tangent(0, 2));
        set(tangent_at + 5, field.tangent(1, 2));
    }
}

void XpbdMembrane::sweep(const XpbdMobility& mobility, const Sweep& sweep) const {
    const SweepArrays arrays{mobility.squared_time, mobility.inverse_mass.data(), sweep.start.data(),
                             sweep.force.data(), sweep.x.data()};
    const bool full = stiffness_.compression == Compression::full;
    const int count = static_cast<int>(batch_.size());
    alignas(64) double response[response_count * xpbd_lanes];
    unsigned squeezed = 0;
    for (int b = 0; b < count;) {
        if (!full) respond(batch_[b], sweep.x, response);
        const int next =
            sweep_batches(stiffness_, batch_.data(), b, full ? count : b + 1, constants_.data(),
                          full ? nullptr : response, arrays, sweep.squeezed ? sweep.also : nullptr, &squeezed);
        for (int lane = 0; squeezed >> lane; ++lane)
            if (squeezed >> lane & 1u) sweep.squeezed(batch_[next - 1].item[lane]);
        b = next;
    }
}

void XpbdMembrane::follow(const XpbdMobility& mobility, const Positions& reached, Positions& kept) const {
    follow_batches(stiffness_, batch_.data(), static_cast<int>(batch_.size()), constants_.data(), mobility.squared_time,
                   mobility.inverse_mass.data(), reached.data(), kept.data());
}

}  // namespace toile::simulate
