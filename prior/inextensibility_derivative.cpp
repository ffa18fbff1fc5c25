#include "prior/inextensibility_derivative.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile::prior {
namespace {

constexpr double wanted_residual = 1e-11;
constexpr double good_residual = 1e-8;
constexpr int most_corrections = 12;

struct alignas(64) LaneNumbers {
    double value[8] = {};
    double& operator[](int l) { return value[l]; }
};

/// Positions and multipliers of a lane; false if one is not finite. The lane then holds zeros.
template <int W>
bool load(InextensibilityBuffers<W>& buffers, int l, const InextensibilityDerivativeLane& lane, double& largest) {
    const int positions = 3 * buffers.shared.vertex_count, edges = buffers.shared.edge_count;
    const auto finite = [](double x) { return std::isfinite(x); };
    const bool usable = lane.position && std::all_of(lane.position, lane.position + positions, finite) &&
                        std::all_of(lane.multiplier, lane.multiplier + edges, finite);
    largest = 0;
    if (!usable) {
        for (int i = 0; i < positions; ++i) buffers.lanes.position[i * W + l] = 0;
        for (int e = 0; e < edges; ++e) buffers.lanes.multiplier[e * W + l] = 0;
        return false;
    }
    for (int c = 0; c < 3; ++c) buffers.origin[l][c] = lane.position[c];
    buffers.load_position(l, lane.position);
    buffers.load_multiplier(l, lane.multiplier);
    for (int e = 0; e < edges; ++e) largest = std::max(largest, buffers.lanes.multiplier[e * W + l]);
    return true;
}

/// The right-hand sides of a lane, and the unknowns at zero.
template <int W>
void load_right_side(InextensibilityBuffers<W>& buffers, int l, const InextensibilityDerivativeLane& lane,
                     bool usable) {
    const InextensibilityLanes<W>& g = buffers.lanes;
    for (int i = 0; i < 3 * g.vertex_count; ++i) {
        double right = 0;
        if (usable) right = lane.loss_gradient ? lane.loss_gradient[i] : g.stiffness[i / 3] * lane.predicted_change[i];
        g.stationarity[i * W + l] = right;
        g.trial[i * W + l] = 0;
    }
    for (int e = 0; e < g.edge_count; ++e) {
        g.multiplier_trial[e * W + l] = usable && lane.limit_change ? lane.limit_change[e] * g.slack[e * W + l] : 0;
        g.multiplier_step[e * W + l] = 0;
    }
}

template <int W>
void store(const InextensibilityBuffers<W>& buffers, int l, InextensibilityDerivativeLane& lane, bool usable) {
    const InextensibilityLanes<W>& g = buffers.lanes;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 3 * g.vertex_count; ++i) {
        const double scale = lane.loss_gradient ? g.stiffness[i / 3] : 1.0;
        lane.result[i] = usable ? scale * g.trial[i * W + l] : nan;
    }
    if (!lane.multiplier_result) return;
    for (int e = 0; e < g.edge_count; ++e) lane.multiplier_result[e] = usable ? g.multiplier_step[e * W + l] : nan;
}

}  // namespace

template <int W>
void differentiate_group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityDerivativeLane, W>& lane,
                         double tolerance) {
    const InextensibilityLanes<W>& g = buffers.lanes;
    LaneNumbers largest, gamma, force, length, first_force, first_length;
    std::array<bool, W> usable;
    for (int l = 0; l < W; ++l) usable[l] = load<W>(buffers, l, lane[l], largest[l]);
    TautMeasure measure;
    find_taut<W>(g, largest.value, 0.1 * std::sqrt(tolerance), measure);
    for (int l = 0; l < W; ++l) {
        load_right_side<W>(buffers, l, lane[l], usable[l]);
        gamma[l] = std::min(1e8 * (1.0 + measure.curvature[l]), 1e12);
    }
    assemble_taut<W>(g, gamma.value);
    const std::bitset<W> good = buffers.cholesky.factor(g.block);
    std::array<double, W> residual{};
    for (int correction = 0; correction <= most_corrections; ++correction) {
        taut_residual<W>(g, gamma.value, force.value, length.value);
        bool done = true;
        for (int l = 0; l < W; ++l) {
            if (correction == 0) {
                first_force[l] = force[l];
                first_length[l] = length[l];
            }
            const double of_force = first_force[l] > 0 ? force[l] / first_force[l] : 0;
            // Both rows are measured in the force that would be needed to make up for them.
            const double scale = std::max(first_force[l], first_length[l]);
            residual[l] = scale > 0 ? std::max(of_force, length[l] / scale) : 0;
            done = done && (!usable[l] || residual[l] <= wanted_residual);
        }
        if (done || correction == most_corrections) break;
        buffers.cholesky.solve(g.step);
        taut_correction<W>(g, gamma.value);
    }
    for (int l = 0; l < W; ++l) {
        if (!lane[l].position) continue;
        DerivativeReport& report = lane[l].report;
        report.status = !usable[l]                                ? Status::rejected_input
                        : good[l] && residual[l] <= good_residual ? Status::converged
                                                                  : Status::accuracy_not_reached;
        report.linear_residual = usable[l] ? residual[l] : std::numeric_limits<double>::quiet_NaN();
        report.taut_edges = static_cast<int>(measure.taut[l]);
        report.weakly_active = static_cast<int>(measure.weak[l]);
        report.active_set_distance = measure.distance[l];
        store<W>(buffers, l, lane[l], usable[l]);
    }
}

template void differentiate_group<1>(InextensibilityBuffers<1>&, std::array<InextensibilityDerivativeLane, 1>&, double);
template void differentiate_group<8>(InextensibilityBuffers<8>&, std::array<InextensibilityDerivativeLane, 8>&, double);

}  // namespace toile::prior
