#include "prior/inextensibility_kernels.h"
#include "prior/lane_vector.h"

namespace toile::prior {
namespace {

constexpr double tiny = 1e-150;
/// A multiplier below this share of the largest is rounding, and the edge free.
constexpr double nothing = 1e-8;

}  // namespace

template <int W>
TOILE_LANE_KERNEL void find_taut(const InextensibilityLanes<W>& g, const double* largest_multiplier, double weak_below,
                                 TautMeasure& measure) {
    const Lane<W> zero = lane_broadcast<W>(0.0), one = lane_broadcast<W>(1.0);
    const Lane<W> inverse = 1.0 / lane_max(load_lanes<W>(largest_multiplier), lane_broadcast<W>(tiny));
    Lane<W> taut = zero, weak = zero, distance = one, curvature = zero;
    for (int e = 0; e < g.edge_count; ++e) {
        LaneVector<W> n = difference<W>(g.position + 3 * g.edge[2 * e] * W, g.position + 3 * g.edge[2 * e + 1] * W);
        const Lane<W> l = lane_sqrt(dot<W>(n, n) + tiny);
        const Lane<W> per_length = 1.0 / l;
        store_vector<W>(g.direction + 3 * e * W, LaneVector<W>{n.x * per_length, n.y * per_length, n.z * per_length});
        const Lane<W> lambda = load_lanes<W>(g.multiplier + e * W);
        const Lane<W> force = lambda * inverse;
        const Lane<W> slack = lane_max(zero, 1.0 - l * (1.0 / g.limit[e]));
        const Lane<W> clear = lane_max(force, slack);
        const LaneMask<W> is_taut = lane_less(slack, force) & lane_less(lane_broadcast<W>(nothing), force);
        const Lane<W> t = lane_select(is_taut, lambda * per_length, zero);
        taut = taut + lane_select(is_taut, one, zero);
        weak = weak + lane_select(lane_less(clear, lane_broadcast<W>(weak_below)), one, zero);
        distance = lane_min(distance, clear);
        curvature = lane_max(curvature, t);
        store_lanes<W>(g.slack + e * W, lane_select(is_taut, one, zero));
        store_lanes<W>(g.target + e * W, t);
    }
    store_lanes<W>(measure.taut, taut);
    store_lanes<W>(measure.weak, weak);
    store_lanes<W>(measure.distance, distance);
    store_lanes<W>(measure.curvature, curvature);
}

template <int W>
TOILE_LANE_KERNEL void assemble_taut(const InextensibilityLanes<W>& g, const double* gamma) {
    for (int v = 0; v < g.vertex_count; ++v)
        for (int c = 0; c < 9; ++c)
            store_lanes<W>(g.block + (9 * v + c) * W, lane_broadcast<W>(c % 4 == 0 ? g.stiffness[v] : 0.0));
    const Lane<W> penalty = load_lanes<W>(gamma);
    for (int e = 0; e < g.edge_count; ++e)
        assemble_edge<W>(g.block + 9 * g.edge[2 * e] * W, g.block + 9 * g.edge[2 * e + 1] * W,
                         g.block + 9 * g.slot[e] * W, penalty * load_lanes<W>(g.slack + e * W),
                         load_lanes<W>(g.target + e * W), load_vector<W>(g.direction + 3 * e * W));
}

template <int W>
TOILE_LANE_KERNEL void taut_residual(const InextensibilityLanes<W>& g, const double* gamma, double* force,
                                     double* length) {
    for (int i = 0; i < 3 * g.vertex_count; ++i) {
        const Lane<W> rest =
            load_lanes<W>(g.stationarity + i * W) - g.stiffness[i / 3] * load_lanes<W>(g.trial + i * W);
        store_lanes<W>(g.step + i * W, rest);
    }
    Lane<W> largest_force = lane_broadcast<W>(0.0), largest_length = largest_force;
    for (int e = 0; e < g.edge_count; ++e) {
        const int a = 3 * g.edge[2 * e], b = 3 * g.edge[2 * e + 1];
        const LaneVector<W> d = difference<W>(g.trial + a * W, g.trial + b * W);
        const LaneVector<W> n = load_vector<W>(g.direction + 3 * e * W);
        const Lane<W> taut = load_lanes<W>(g.slack + e * W), t = load_lanes<W>(g.target + e * W);
        const Lane<W> along = dot<W>(n, d);
        const Lane<W> rest = taut * (load_lanes<W>(g.multiplier_trial + e * W) - along);
        largest_length = lane_max(largest_length, lane_abs(rest));
        store_lanes<W>(g.slack_trial + e * W, rest);
        // t (d − n nᵀd) + n b of the matrix; γ n rest is added in a pass of its own, as it is no part of the residual.
        const Lane<W> c = load_lanes<W>(g.multiplier_step + e * W) - t * along;
        add_opposite<W>(g.step + b * W, g.step + a * W, lane_broadcast<W>(1.0),
                        LaneVector<W>{t * d.x + c * n.x, t * d.y + c * n.y, t * d.z + c * n.z});
    }
    for (int v = 0; v < g.vertex_count; ++v)
        largest_force = largest_of<W>(largest_force, load_vector<W>(g.step + 3 * v * W));
    const Lane<W> penalty = load_lanes<W>(gamma);
    for (int e = 0; e < g.edge_count; ++e)
        add_opposite<W>(g.step + 3 * g.edge[2 * e] * W, g.step + 3 * g.edge[2 * e + 1] * W,
                        penalty * load_lanes<W>(g.slack_trial + e * W), load_vector<W>(g.direction + 3 * e * W));
    store_lanes<W>(force, largest_force);
    store_lanes<W>(length, largest_length);
}

template <int W>
TOILE_LANE_KERNEL void taut_correction(const InextensibilityLanes<W>& g, const double* gamma) {
    for (int i = 0; i < 3 * g.vertex_count; ++i)
        store_lanes<W>(g.trial + i * W, load_lanes<W>(g.trial + i * W) + load_lanes<W>(g.step + i * W));
    const Lane<W> penalty = load_lanes<W>(gamma);
    for (int e = 0; e < g.edge_count; ++e) {
        const LaneVector<W> d = difference<W>(g.step + 3 * g.edge[2 * e] * W, g.step + 3 * g.edge[2 * e + 1] * W);
        const Lane<W> along = dot<W>(load_vector<W>(g.direction + 3 * e * W), d);
        const Lane<W> by = penalty * (load_lanes<W>(g.slack + e * W) * along - load_lanes<W>(g.slack_trial + e * W));
        store_lanes<W>(g.multiplier_step + e * W, load_lanes<W>(g.multiplier_step + e * W) + by);
    }
}

#define TOILE_INSTANTIATE(W)                                                                         \
    template void find_taut<W>(const InextensibilityLanes<W>&, const double*, double, TautMeasure&); \
    template void assemble_taut<W>(const InextensibilityLanes<W>&, const double*);                   \
    template void taut_residual<W>(const InextensibilityLanes<W>&, const double*, double*, double*); \
    template void taut_correction<W>(const InextensibilityLanes<W>&, const double*);
TOILE_INSTANTIATE(1)
TOILE_INSTANTIATE(8)
#undef TOILE_INSTANTIATE

}  // namespace toile::prior
