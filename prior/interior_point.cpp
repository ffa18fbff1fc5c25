#include "prior/interior_point.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace toile::prior {
namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time since it was made, or since the last `lap`, to a stage.
class Lap {
  public:
    void lap(double& stage) {
        const Clock::time_point now = Clock::now();
        stage += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    Clock::time_point last_ = Clock::now();
};

template <int W>
struct alignas(64) PerLane {
    double value[W < 8 ? 8 : W] = {};
    double& operator[](int l) { return value[l]; }
    double operator[](int l) const { return value[l]; }
};

template <int W>
class Group {
  public:
    Group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityLane, W>& lane,
          const InextensibilityOptions& options, StageSeconds& seconds)
        : buffers_(buffers), g_(buffers.lanes), lane_(lane), options_(options), seconds_(seconds) {}

    void load();
    void begin(const InteriorPointStart& start);
    void iterate(int budget);

  private:
    void sweep(int count);
    void recall();
    bool check(int iteration);
    void step(int iteration);
    void finish(int l, Status status, int iterations);
    bool any_running() const {
        return std::any_of(running_.begin(), running_.end(), [](bool r) { return r; });
    }

    InextensibilityBuffers<W>& buffers_;
    const InextensibilityLanes<W>& g_;
    std::array<InextensibilityLane, W>& lane_;
    const InextensibilityOptions& options_;
    StageSeconds& seconds_;
    std::array<bool, W> running_{};
    InextensibilityMeasure measure_;
    Lap lap_;
};

template <int W>
void Group<W>::finish(int l, Status status, int iterations) {
    Report& report = lane_[l].report;
    report.status = status;
    report.iterations = iterations;
    buffers_.store_position(l, lane_[l].position);
    buffers_.store_multiplier(l, lane_[l].multiplier);
    running_[l] = false;
}

template <int W>
void Group<W>::load() {
    for (int l = 0; l < W; ++l) {
        // A lane without a sample repeats the first one: it must hold something that computes.
        const double* predicted = lane_[l].predicted ? lane_[l].predicted : lane_[0].predicted;
        const bool finite = buffers_.load_predicted(l, predicted);
        if (!lane_[l].predicted) continue;
        running_[l] = finite;
        if (finite) continue;
        lane_[l].report.status = Status::rejected_input;
        lane_[l].report.residual = std::numeric_limits<double>::quiet_NaN();
        std::fill_n(lane_[l].position, 3 * g_.vertex_count, std::numeric_limits<double>::quiet_NaN());
        std::fill_n(lane_[l].multiplier, g_.edge_count, std::numeric_limits<double>::quiet_NaN());
    }
    lap_.lap(seconds_.assembly);
}

/// Brings position, multipliers and slacks near the central path. A prediction that keeps its limits
/// is the answer.
template <int W>
void Group<W>::begin(const InteriorPointStart& start) {
    const double penalty = buffers_.shared.penalty;
    PerLane<W> largest, over, mu;
    begin_sweeps<W>(g_, penalty);
    measure_sweeps<W>(g_, penalty, largest.value, over.value);
    for (int l = 0; l < W; ++l) {
        if (!running_[l] || over[l] > options_.tolerance) continue;
        std::copy_n(lane_[l].predicted, 3 * g_.vertex_count, lane_[l].position);
        std::fill_n(lane_[l].multiplier, g_.edge_count, 0.0);
        lane_[l].report.status = Status::converged;
        running_[l] = false;
    }
    if (!any_running()) return;
    const bool warm = std::any_of(lane_.begin(), lane_.end(), [](const InextensibilityLane& l) { return l.warm; });
    if (warm) recall();
    if (!any_running()) return;
    sweep(start.sweeps);
    measure_sweeps<W>(g_, penalty, largest.value, over.value);
    for (int l = 0; l < W; ++l)
        mu[l] = std::max(largest[l], 1e-12) * std::clamp(0.2 * over[l], start.least_centre, 1.0);
    smooth_start<W>(g_, penalty, mu.value);
    lap_.lap(seconds_.sweep);
}

template <int W>
void Group<W>::sweep(int count) {
    for (int s = 0; s < count; ++s) {
        buffers_.shared.constant->template solve<W>(g_.step);
        finish_sweep<W>(g_, buffers_.shared.penalty);
    }
    for (InextensibilityLane& lane : lane_) lane.report.sweeps += count;
}

/// Starts the sweeps from earlier solutions. One that still is the answer ends its lane.
template <int W>
void Group<W>::recall() {
    for (int l = 0; l < W; ++l) {
        if (!running_[l] || !lane_[l].warm) continue;
        buffers_.load_position(l, lane_[l].position);
        buffers_.load_multiplier(l, lane_[l].multiplier);
    }
    linearise<W>(g_, measure_);
    check(0);
    resume_sweeps<W>(g_, buffers_.shared.penalty);
}

/// Ends the lanes that have arrived or broken down; false when none is left.
template <int W>
bool Group<W>::check(int iteration) {
    for (int l = 0; l < W; ++l) {
        if (!running_[l]) continue;
        const double scale = std::max(measure_.multiplier[l], measure_.force[l]);
        const double residual = std::max(
            {measure_.overlength[l], measure_.stationarity[l] / scale, measure_.complementarity[l] / scale, 0.0});
        if (!std::isfinite(residual)) {
            // Nothing of this lane can be used: its prediction stands, with no forces.
            std::copy_n(lane_[l].predicted, 3 * g_.vertex_count, lane_[l].position);
            std::fill_n(lane_[l].multiplier, g_.edge_count, 0.0);
            lane_[l].report.status = Status::accuracy_not_reached;
            lane_[l].report.iterations = iteration;
            running_[l] = false;
        } else if (residual <= options_.tolerance) {
            finish(l, Status::converged, iteration);
        } else if (iteration == options_.max_iterations) {
            finish(l, Status::accuracy_not_reached, iteration);
        }
    }
    return any_running();
}

template <int W>
void Group<W>::step(int iteration) {
    PerLane<W> inverse, centre, length, reach, trial_inverse, use_trial;
    const std::bitset<W> good = buffers_.cholesky.factor_and_solve(g_.block, g_.step);
    lap_.lap(seconds_.factor);
    for (int l = 0; l < W; ++l)
        if (running_[l] && !good[l]) finish(l, Status::accuracy_not_reached, iteration);
    measure_affine<W>(g_, inverse.value);
    for (int l = 0; l < W; ++l) {
        const double affine = 1.0 / std::max(inverse[l], 1.0);
        const double rest = 1.0 - affine;
        centre[l] = running_[l] ? rest * rest * rest * measure_.gap[l] : 0.0;
    }
    aim_at_centre<W>(g_, centre.value);
    lap_.lap(seconds_.assembly);
    buffers_.cholesky.solve(g_.step);
    lap_.lap(seconds_.solve);
    measure_step<W>(g_, false, inverse.value);
    bool short_step = false;
    for (int l = 0; l < W; ++l) {
        length[l] = 1.0 / std::max(inverse[l], 1.0);
        reach[l] = std::min(1.0, std::max(1.5 * length[l], length[l] + 0.3));
        short_step = short_step || (running_[l] && length[l] < 0.95);
    }
    if (short_step) {
        aim_at_products<W>(g_, reach.value, centre.value);
        lap_.lap(seconds_.assembly);
        buffers_.cholesky.solve(g_.trial);
        lap_.lap(seconds_.solve);
        measure_step<W>(g_, true, trial_inverse.value);
        for (int l = 0; l < W; ++l) {
            const double corrected = 1.0 / std::max(trial_inverse[l], 1.0);
            if (length[l] >= 0.95 || corrected < length[l]) continue;
            length[l] = corrected;
            use_trial[l] = 1.0;
        }
    }
    for (int l = 0; l < W; ++l) {
        const double short_of = std::min(0.1, measure_.gap[l] / std::max(measure_.multiplier[l], 1e-300));
        length[l] = running_[l] ? std::min(1.0, (1.0 - short_of) * length[l]) : 0.0;
        if (!std::isfinite(length[l])) length[l] = 0.0;
    }
    advance<W>(g_, length.value, use_trial.value);
    lap_.lap(seconds_.assembly);
}

template <int W>
void Group<W>::iterate(int budget) {
    for (int iteration = 0; any_running(); ++iteration) {
        linearise<W>(g_, measure_);
        lap_.lap(seconds_.assembly);
        if (!check(iteration) || iteration == budget) break;
        step(iteration);
    }
}

}  // namespace

template <int W>
void project_group(InextensibilityBuffers<W>& buffers, std::array<InextensibilityLane, W>& lane,
                   const InextensibilityOptions& options, const InteriorPointStart& start, StageSeconds& seconds) {
    Group<W> group(buffers, lane, options, seconds);
    group.load();
    group.begin(start);
    group.iterate(options.max_iterations);
}

template void project_group<1>(InextensibilityBuffers<1>&, std::array<InextensibilityLane, 1>&,
                               const InextensibilityOptions&, const InteriorPointStart&, StageSeconds&);
template void project_group<8>(InextensibilityBuffers<8>&, std::array<InextensibilityLane, 8>&,
                               const InextensibilityOptions&, const InteriorPointStart&, StageSeconds&);

}  // namespace toile::prior
