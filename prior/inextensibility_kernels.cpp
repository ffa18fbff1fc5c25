#include "prior/inextensibility_kernels.h"

#include "prior/lane_vector.h"

namespace toile::prior {
namespace {

/// Shorter edges, as a share of their limit, count as this long where a direction or a curvature is divided by l.
constexpr double shortest = 1e-3;
constexpr double tiny = 1e-150;
constexpr double relaxation = 1.6;

}  // namespace

template <int W>
TOILE_LANE_KERNEL void begin_sweeps(const InextensibilityLanes<W>& g, double penalty) {
    for (int i = 0; i < 3 * g.vertex_count; ++i) {
        const Lane<W> x = load_lanes<W>(g.predicted + i * W);
        store_lanes<W>(g.position + i * W, x);
        store_lanes<W>(g.step + i * W, x * g.stiffness[i / 3]);
    }
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        LaneVector<W> z = difference<W>(g.position + a * W, g.position + b * W);
        const Lane<W> l = lane_sqrt(dot<W>(z, z) + tiny);
        const Lane<W> f = lane_min(lane_broadcast<W>(1.0), g.limit[e] / l);
        z = {f * z.x, f * z.y, f * z.z};
        store_vector<W>(g.split + 3 * e * W, z);
        store_vector<W>(g.dual + 3 * e * W, LaneVector<W>{0.0 * z.x, 0.0 * z.x, 0.0 * z.x});
        add_opposite<W>(g.step + a * W, g.step + b * W, lane_broadcast<W>(penalty), z);
    }
}

template <int W>
TOILE_LANE_KERNEL void finish_sweep(const InextensibilityLanes<W>& g, double penalty) {
    for (int i = 0; i < 3 * g.vertex_count; ++i) {
        store_lanes<W>(g.position + i * W, load_lanes<W>(g.step + i * W));
        store_lanes<W>(g.step + i * W, load_lanes<W>(g.predicted + i * W) * g.stiffness[i / 3]);
    }
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const LaneVector<W> d = difference<W>(g.position + a * W, g.position + b * W);
        const LaneVector<W> z = load_vector<W>(g.split + 3 * e * W), u = load_vector<W>(g.dual + 3 * e * W);
        constexpr double stay = 1.0 - relaxation;
        const LaneVector<W> q{relaxation * d.x + stay * z.x + u.x, relaxation * d.y + stay * z.y + u.y,
                              relaxation * d.z + stay * z.z + u.z};
        const Lane<W> l = lane_sqrt(dot<W>(q, q) + tiny);
        const Lane<W> f = lane_min(lane_broadcast<W>(1.0), g.limit[e] / l);
        const LaneVector<W> within{f * q.x, f * q.y, f * q.z};
        const LaneVector<W> beyond{q.x - within.x, q.y - within.y, q.z - within.z};
        store_vector<W>(g.split + 3 * e * W, within);
        store_vector<W>(g.dual + 3 * e * W, beyond);
        add_opposite<W>(g.step + a * W, g.step + b * W, lane_broadcast<W>(penalty),
                        LaneVector<W>{within.x - beyond.x, within.y - beyond.y, within.z - beyond.z});
    }
}

template <int W>
TOILE_LANE_KERNEL void measure_sweeps(const InextensibilityLanes<W>& g, double penalty, double* largest,
                                      double* overlength) {
    Lane<W> u2 = lane_broadcast<W>(0.0), over = lane_broadcast<W>(0.0);
    for (int e = 0; e < g.edge_count; ++e) {
        const LaneVector<W> u = load_vector<W>(g.dual + 3 * e * W);
        const LaneVector<W> d =
            difference<W>(g.position + 3 * g.edge[2 * e] * W, g.position + 3 * g.edge[2 * e + 1] * W);
        u2 = lane_max(u2, dot<W>(u, u));
        over = lane_max(over, lane_sqrt(dot<W>(d, d)) / g.limit[e] - 1.0);
    }
    store_lanes<W>(largest, penalty * lane_sqrt(u2));
    store_lanes<W>(overlength, over);
}

template <int W>
TOILE_LANE_KERNEL void smooth_start(const InextensibilityLanes<W>& g, double penalty, const double* mu) {
    const Lane<W> product = load_lanes<W>(mu);
    for (int e = 0; e < g.edge_count; ++e) {
        const LaneVector<W> d =
            difference<W>(g.position + 3 * g.edge[2 * e] * W, g.position + 3 * g.edge[2 * e + 1] * W);
        const LaneVector<W> u = load_vector<W>(g.dual + 3 * e * W);
        const LaneVector<W> q{d.x + u.x, d.y + u.y, d.z + u.z};
        const Lane<W> over = lane_sqrt(dot<W>(q, q)) - g.limit[e];
        const Lane<W> m = product * g.limit[e] / penalty;
        // s (s + over) = m with s > 0, written without cancellation for either sign.
        const Lane<W> root = lane_sqrt(over * over + 4.0 * m);
        const Lane<W> sum = 0.5 * (root + lane_abs(over));
        const Lane<W> other = m / sum;
        const LaneMask<W> inside = lane_less(over, lane_broadcast<W>(0.0));
        // A slack beyond the limit would ask for a negative length.
        const Lane<W> s = lane_min(lane_select(inside, sum, other), lane_broadcast<W>(g.limit[e]));
        store_lanes<W>(g.slack + e * W, s);
        store_lanes<W>(g.multiplier + e * W, penalty * m / s);
    }
}

template <int W>
TOILE_LANE_KERNEL void resume_sweeps(const InextensibilityLanes<W>& g, double penalty) {
    for (int i = 0; i < 3 * g.vertex_count; ++i)
        store_lanes<W>(g.step + i * W, load_lanes<W>(g.predicted + i * W) * g.stiffness[i / 3]);
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const LaneVector<W> d = difference<W>(g.position + a * W, g.position + b * W);
        const Lane<W> l = lane_sqrt(dot<W>(d, d) + tiny);
        const Lane<W> f = lane_min(lane_broadcast<W>(1.0), g.limit[e] / l);
        const Lane<W> h = load_lanes<W>(g.multiplier + e * W) / (penalty * l);
        store_vector<W>(g.split + 3 * e * W, LaneVector<W>{f * d.x, f * d.y, f * d.z});
        store_vector<W>(g.dual + 3 * e * W, LaneVector<W>{h * d.x, h * d.y, h * d.z});
        add_opposite<W>(g.step + a * W, g.step + b * W, penalty * (f - h), d);
    }
}

template <int W>
TOILE_LANE_KERNEL void linearise(const InextensibilityLanes<W>& g, InextensibilityMeasure& measure) {
    const Lane<W> zero = lane_broadcast<W>(0.0);
    Lane<W> force = zero, over = lane_broadcast<W>(-1.0), comp = zero, most = zero, gap = zero, stat = zero;
    for (int v = 0; v < g.vertex_count; ++v) {
        const double k = g.stiffness[v];
        double* diagonal = g.block + 9 * v * W;
        for (int c = 0; c < 9; ++c) store_lanes<W>(diagonal + c * W, lane_broadcast<W>(c % 4 == 0 ? k : 0.0));
        LaneVector<W> f = difference<W>(g.position + 3 * v * W, g.predicted + 3 * v * W);
        f = {k * f.x, k * f.y, k * f.z};
        force = largest_of<W>(force, f);
        store_vector<W>(g.stationarity + 3 * v * W, f);
        store_vector<W>(g.step + 3 * v * W, LaneVector<W>{-f.x, -f.y, -f.z});
    }
    for (int e = 0; e < g.edge_count; ++e) {
        const int va = g.edge[2 * e], vb = g.edge[2 * e + 1], a = 3 * va, b = 3 * vb;
        const double limit = g.limit[e];
        LaneVector<W> n = difference<W>(g.position + a * W, g.position + b * W);
        const Lane<W> l = lane_sqrt(dot<W>(n, n) + tiny);
        const Lane<W> inverse = 1.0 / l;
        n = {n.x * inverse, n.y * inverse, n.z * inverse};
        store_vector<W>(g.direction + 3 * e * W, n);
        const Lane<W> s = load_lanes<W>(g.slack + e * W), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> beyond = l - limit, p = beyond + s;
        store_lanes<W>(g.primal + e * W, p);
        gap = gap + lambda * s;
        over = lane_max(over, beyond * (1.0 / limit));
        comp = lane_max(comp, lambda * lane_abs(beyond) * (1.0 / limit));
        most = lane_max(most, lambda);
        const Lane<W> along = lambda / s;
        const Lane<W> across = lambda / lane_max(l, lane_broadcast<W>(shortest * limit));
        add_opposite<W>(g.stationarity + a * W, g.stationarity + b * W, lambda, n);
        add_opposite<W>(g.step + b * W, g.step + a * W, along * p, n);
        assemble_edge<W>(g.block + 9 * va * W, g.block + 9 * vb * W, g.block + 9 * g.slot[e] * W, along, across, n);
    }
    for (int v = 0; v < g.vertex_count; ++v) stat = largest_of<W>(stat, load_vector<W>(g.stationarity + 3 * v * W));
    store_lanes<W>(measure.stationarity, stat);
    store_lanes<W>(measure.force, force);
    store_lanes<W>(measure.overlength, over);
    store_lanes<W>(measure.complementarity, comp);
    store_lanes<W>(measure.multiplier, most);
    store_lanes<W>(measure.gap, gap * (1.0 / g.edge_count));
}

template <int W>
TOILE_LANE_KERNEL void measure_solution(const InextensibilityLanes<W>& g, InextensibilityMeasure& measure) {
    const Lane<W> zero = lane_broadcast<W>(0.0);
    Lane<W> force = zero, over = lane_broadcast<W>(-1.0), comp = zero, most = zero, stat = zero;
    for (int v = 0; v < g.vertex_count; ++v) {
        LaneVector<W> f = difference<W>(g.position + 3 * v * W, g.predicted + 3 * v * W);
        f = {g.stiffness[v] * f.x, g.stiffness[v] * f.y, g.stiffness[v] * f.z};
        force = largest_of<W>(force, f);
        store_vector<W>(g.stationarity + 3 * v * W, f);
    }
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const LaneVector<W> d = difference<W>(g.position + a * W, g.position + b * W);
        const Lane<W> l = lane_sqrt(dot<W>(d, d) + tiny), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> beyond = (l - g.limit[e]) * (1.0 / g.limit[e]);
        over = lane_max(over, beyond);
        comp = lane_max(comp, lambda * lane_abs(beyond));
        most = lane_max(most, lambda);
        add_opposite<W>(g.stationarity + a * W, g.stationarity + b * W, lambda / l, d);
    }
    for (int v = 0; v < g.vertex_count; ++v) stat = largest_of<W>(stat, load_vector<W>(g.stationarity + 3 * v * W));
    store_lanes<W>(measure.stationarity, stat);
    store_lanes<W>(measure.force, force);
    store_lanes<W>(measure.overlength, over);
    store_lanes<W>(measure.complementarity, comp);
    store_lanes<W>(measure.multiplier, most);
    store_lanes<W>(measure.gap, zero);
}

template <int W>
TOILE_LANE_KERNEL void measure_affine(const InextensibilityLanes<W>& g, double* inverse_length) {
    Lane<W> worst = lane_broadcast<W>(0.0);
    for (int e = 0; e < g.edge_count; ++e) {
        const LaneVector<W> d = difference<W>(g.step + 3 * g.edge[2 * e] * W, g.step + 3 * g.edge[2 * e + 1] * W);
        const Lane<W> s = load_lanes<W>(g.slack + e * W), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> ds = -dot<W>(load_vector<W>(g.direction + 3 * e * W), d) - load_lanes<W>(g.primal + e * W);
        const Lane<W> share = ds / s;  // Δλ / λ = −(1 + Δs / s)
        worst = lane_max(worst, lane_max(-share, 1.0 + share));
        store_lanes<W>(g.target + e * W, -ds * lambda * (1.0 + share));
    }
    store_lanes<W>(inverse_length, worst);
}

template <int W>
TOILE_LANE_KERNEL void aim_at_centre(const InextensibilityLanes<W>& g, const double* centre) {
    for (int i = 0; i < 3 * g.vertex_count; ++i) store_lanes<W>(g.step + i * W, -load_lanes<W>(g.stationarity + i * W));
    const Lane<W> product = load_lanes<W>(centre);
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const Lane<W> s = load_lanes<W>(g.slack + e * W), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> aim = product - lambda * s - load_lanes<W>(g.target + e * W);
        store_lanes<W>(g.target + e * W, aim);
        const Lane<W> f = (aim + lambda * load_lanes<W>(g.primal + e * W)) / s;
        add_opposite<W>(g.step + b * W, g.step + a * W, f, load_vector<W>(g.direction + 3 * e * W));
    }
}

template <int W>
TOILE_LANE_KERNEL void measure_step(const InextensibilityLanes<W>& g, bool trial, double* inverse_length) {
    const double* step = trial ? g.trial : g.step;
    double* slack_step = trial ? g.slack_trial : g.slack_step;
    double* multiplier_step = trial ? g.multiplier_trial : g.multiplier_step;
    Lane<W> worst = lane_broadcast<W>(0.0);
    for (int e = 0; e < g.edge_count; ++e) {
        const LaneVector<W> d = difference<W>(step + 3 * g.edge[2 * e] * W, step + 3 * g.edge[2 * e + 1] * W);
        const Lane<W> s = load_lanes<W>(g.slack + e * W), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> ds = -dot<W>(load_vector<W>(g.direction + 3 * e * W), d) - load_lanes<W>(g.primal + e * W);
        // One division for both ratios: 1 / s = λ / (λ s).
        const Lane<W> inverse = 1.0 / (lambda * s);
        const Lane<W> per_slack = lambda * inverse, per_multiplier = s * inverse;
        const Lane<W> dl = (load_lanes<W>(g.target + e * W) - lambda * ds) * per_slack;
        worst = lane_max(worst, lane_max(-ds * per_slack, -dl * per_multiplier));
        store_lanes<W>(slack_step + e * W, ds);
        store_lanes<W>(multiplier_step + e * W, dl);
    }
    store_lanes<W>(inverse_length, worst);
}

template <int W>
TOILE_LANE_KERNEL void aim_at_products(const InextensibilityLanes<W>& g, const double* reach, const double* centre) {
    for (int i = 0; i < 3 * g.vertex_count; ++i)
        store_lanes<W>(g.trial + i * W, -load_lanes<W>(g.stationarity + i * W));
    const Lane<W> length = load_lanes<W>(reach), middle = load_lanes<W>(centre);
    const Lane<W> low = 0.1 * middle, high = 10.0 * middle;
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const Lane<W> s = load_lanes<W>(g.slack + e * W), lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> product = (s + length * load_lanes<W>(g.slack_step + e * W)) *
                                (lambda + length * load_lanes<W>(g.multiplier_step + e * W));
        const Lane<W> pull = lane_max(lane_min(lane_max(product, low), high) - product, -high);
        const Lane<W> aim = load_lanes<W>(g.target + e * W) + pull;
        store_lanes<W>(g.target + e * W, aim);
        const Lane<W> f = (aim + lambda * load_lanes<W>(g.primal + e * W)) / s;
        add_opposite<W>(g.trial + b * W, g.trial + a * W, f, load_vector<W>(g.direction + 3 * e * W));
    }
}

template <int W>
TOILE_LANE_KERNEL void advance(const InextensibilityLanes<W>& g, const double* length, const double* use_trial) {
    const Lane<W> t = load_lanes<W>(length), zero = lane_broadcast<W>(0.0);
    const LaneMask<W> trial = lane_less(zero, load_lanes<W>(use_trial));
    // A lane that stands still may hold anything in its step, also NaN: it must not be multiplied by zero.
    const LaneMask<W> goes = lane_less(zero, t);
    const auto move = [&] [[gnu::always_inline]] (double* x, const double* step, const double* other) {
        const Lane<W> old = load_lanes<W>(x);
        const Lane<W> by = lane_select(trial, load_lanes<W>(other), load_lanes<W>(step));
        store_lanes<W>(x, lane_select(goes, old + t * by, old));
    };
    for (int i = 0; i < 3 * g.vertex_count; ++i) move(g.position + i * W, g.step + i * W, g.trial + i * W);
    for (int e = 0; e < g.edge_count; ++e) {
        move(g.slack + e * W, g.slack_step + e * W, g.slack_trial + e * W);
        move(g.multiplier + e * W, g.multiplier_step + e * W, g.multiplier_trial + e * W);
    }
}

#define TOILE_INSTANTIATE(W)                                                                        \
    template void begin_sweeps<W>(const InextensibilityLanes<W>&, double);                          \
    template void finish_sweep<W>(const InextensibilityLanes<W>&, double);                          \
    template void measure_sweeps<W>(const InextensibilityLanes<W>&, double, double*, double*);      \
    template void smooth_start<W>(const InextensibilityLanes<W>&, double, const double*);           \
    template void resume_sweeps<W>(const InextensibilityLanes<W>&, double);                         \
    template void linearise<W>(const InextensibilityLanes<W>&, InextensibilityMeasure&);            \
    template void measure_solution<W>(const InextensibilityLanes<W>&, InextensibilityMeasure&);     \
    template void measure_affine<W>(const InextensibilityLanes<W>&, double*);                       \
    template void aim_at_centre<W>(const InextensibilityLanes<W>&, const double*);                  \
    template void measure_step<W>(const InextensibilityLanes<W>&, bool, double*);                   \
    template void aim_at_products<W>(const InextensibilityLanes<W>&, const double*, const double*); \
    template void advance<W>(const InextensibilityLanes<W>&, const double*, const double*);
TOILE_INSTANTIATE(1)
TOILE_INSTANTIATE(8)
#undef TOILE_INSTANTIATE

}  // namespace toile::prior
