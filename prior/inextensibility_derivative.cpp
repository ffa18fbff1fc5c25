#include "prior/inextensibility_derivative.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile::prior {
namespace {

constexpr double wanted_residual = 1e-13;
constexpr double good_residual = 1e-11;  // what the report calls converged; ends a lane whose corrections help no more

/// What is tried in turn: γ relative to H, a bound on it, and how many corrections. Nearly redundant taut edges want a
/// large one, forces of very different size a small one.
struct Attempt {
    double gamma, most_gamma;
    int corrections;
};
constexpr Attempt attempts[] = {{1e8, 1e12, 10}, {1e12, 1e15, 20}, {1e5, 1e9, 40}};

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

/// One group's lanes through an attempt: each is stored when it has arrived, so that it does not depend on the others.
template <int W>
class TautSystem {
  public:
    TautSystem(InextensibilityBuffers<W>& buffers, std::array<InextensibilityDerivativeLane, W>& lane, double tolerance)
        : buffers_(buffers), g_(buffers.lanes), lane_(lane) {
        for (int l = 0; l < W; ++l) {
            usable_[l] = load<W>(buffers_, l, lane_[l], largest_[l]);
            best_[l] = std::numeric_limits<double>::infinity();
        }
        find_taut<W>(g_, largest_.value, 0.1 * std::sqrt(tolerance), measure_);
    }

    bool solve(const Attempt& attempt);
    void report();

  private:
    void correct(const Attempt& attempt);
    void arrive(int l);

    InextensibilityBuffers<W>& buffers_;
    const InextensibilityLanes<W>& g_;
    std::array<InextensibilityDerivativeLane, W>& lane_;
    LaneNumbers largest_, gamma_;
    TautMeasure measure_;
    std::array<bool, W> usable_{}, going_{};
    std::array<double, W> residual_{}, best_{};
};

/// Keeps what a lane holds now, if it is the best so far.
template <int W>
void TautSystem<W>::arrive(int l) {
    going_[l] = false;
    if (!(residual_[l] < best_[l])) return;
    best_[l] = residual_[l];
    store<W>(buffers_, l, lane_[l], true);
}

/// True if every lane has arrived.
template <int W>
bool TautSystem<W>::solve(const Attempt& attempt) {
    bool any = false;
    for (int l = 0; l < W; ++l) {
        load_right_side<W>(buffers_, l, lane_[l], usable_[l]);
        gamma_[l] = std::min(attempt.gamma * (1.0 + measure_.curvature[l]), attempt.most_gamma);
        going_[l] = usable_[l] && !(best_[l] <= good_residual);
        any = any || going_[l];
    }
    if (!any) return true;
    assemble_taut<W>(g_, gamma_.value);
    correct(attempt);
    for (int l = 0; l < W; ++l)
        if (usable_[l] && !(best_[l] <= good_residual)) return false;
    return true;
}

template <int W>
void TautSystem<W>::correct(const Attempt& attempt) {
    LaneNumbers force, length, scale;
    for (int correction = 0;; ++correction) {
        taut_residual<W>(g_, gamma_.value, force.value, length.value);
        for (int l = 0; l < W; ++l) {
            if (correction == 0) {
                // Both rows are measured against the larger right-hand side.
                scale[l] = std::max(force[l], length[l]);
            }
            if (!going_[l]) continue;
            const double before = residual_[l];
            residual_[l] = scale[l] > 0 ? std::max(force[l], length[l]) / scale[l] : 0;
            const bool stalled = correction > 0 && residual_[l] <= good_residual && residual_[l] > 0.5 * before;
            if (!std::isfinite(residual_[l]))
                going_[l] = false;
            else if (residual_[l] <= wanted_residual || stalled || correction == attempt.corrections)
                arrive(l);
        }
        if (std::none_of(going_.begin(), going_.end(), [](bool g) { return g; })) return;
        if (correction == 0) {
            const std::bitset<W> good = buffers_.cholesky->factor_and_solve(g_.block, g_.step);
            for (int l = 0; l < W; ++l) going_[l] = going_[l] && good[l];
        } else {
            buffers_.cholesky->solve(g_.step);
        }
        taut_correction<W>(g_, gamma_.value);
    }
}

template <int W>
void TautSystem<W>::report() {
    for (int l = 0; l < W; ++l) {
        if (!lane_[l].position) continue;
        DerivativeReport& report = lane_[l].report;
        report.linear_residual = usable_[l] ? best_[l] : std::numeric_limits<double>::quiet_NaN();
        report.status = !usable_[l]                 ? Status::rejected_input
                        : best_[l] <= good_residual ? Status::converged
                                                    : Status::accuracy_not_reached;
        report.taut_edges = static_cast<int>(measure_.taut[l]);
        report.weakly_active = static_cast<int>(measure_.weak[l]);
        report.active_set_distance = measure_.distance[l];
        if (!std::isfinite(best_[l])) store<W>(buffers_, l, lane_[l], false);
    }
}

}  // namespace

template <int W>
void differentiate_group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityDerivativeLane, W>& lane,
                         double tolerance) {
    buffers.make_matrix();
    TautSystem<W> system(buffers, lane, tolerance);
    for (const Attempt& attempt : attempts)
        if (system.solve(attempt)) break;
    system.report();
}

template void differentiate_group<1>(InextensibilityBuffers<1>&, std::array<InextensibilityDerivativeLane, 1>&, double);
template void differentiate_group<8>(InextensibilityBuffers<8>&, std::array<InextensibilityDerivativeLane, 8>&, double);

}  // namespace toile::prior
