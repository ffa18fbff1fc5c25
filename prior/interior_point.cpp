#include "prior/interior_point.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

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

/// Largest part of the residual that the contract defines, of a lane.
double relative_residual(const InextensibilityMeasure& measure, int l) {
    const double scale = std::max(measure.multiplier[l], measure.force[l]);
    return std::max({measure.overlength[l], measure.stationarity[l] / scale, measure.complementarity[l] / scale, 0.0});
}

template <int W>
void finish(const InextensibilityBuffers<W>& buffers, int l, InextensibilityTask& task, Status status, int iterations) {
    task.report.status = status;
    task.report.iterations = iterations;
    buffers.store_position(l, task.position);
    buffers.store_multiplier(l, task.multiplier);
}

/// Up to W samples being brought near the central path.
template <int W>
class Preparation {
  public:
    Preparation(InextensibilityBuffers<W>& buffers, const InextensibilityOptions& options,
                const InteriorPointStart& start, StageSeconds& seconds)
        : buffers_(buffers), g_(buffers.lanes), options_(options), start_(start), seconds_(seconds) {}

    /// Takes the next samples and prepares them. Those that need no interior point are finished here.
    void prepare(std::span<InextensibilityTask> task);
    /// A lane that is prepared and has not been taken yet; -1: none is left.
    int next() const;
    InextensibilityTask* take(int l) { return std::exchange(task_[l], nullptr); }
    const InextensibilityBuffers<W>& buffers() const { return buffers_; }

  private:
    void load(std::span<InextensibilityTask> task);
    void recall();
    void sweep();

    InextensibilityBuffers<W>& buffers_;
    const InextensibilityLanes<W>& g_;
    const InextensibilityOptions& options_;
    const InteriorPointStart& start_;
    StageSeconds& seconds_;
    std::array<InextensibilityTask*, W> task_{};
};

template <int W>
int Preparation<W>::next() const {
    for (int l = 0; l < W; ++l)
        if (task_[l]) return l;
    return -1;
}

template <int W>
void Preparation<W>::load(std::span<InextensibilityTask> task) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int l = 0; l < W; ++l) {
        // A lane without a sample repeats the first one: it must hold something that computes.
        const bool used = l < static_cast<int>(task.size());
        InextensibilityTask& from = task[used ? l : 0];
        const bool finite = buffers_.load_predicted(l, from.predicted);
        task_[l] = used && finite ? &from : nullptr;
        if (finite || !used) continue;
        from.report.status = Status::rejected_input;
        from.report.residual = nan;
        std::fill_n(from.position, 3 * g_.vertex_count, nan);
        std::fill_n(from.multiplier, g_.edge_count, nan);
    }
}

template <int W>
void Preparation<W>::prepare(std::span<InextensibilityTask> task) {
    Lap lap;
    const double penalty = buffers_.shared.penalty;
    PerLane<W> largest, over, mu;
    load(task);
    begin_sweeps<W>(g_, penalty);
    measure_sweeps<W>(g_, penalty, largest.value, over.value);
    for (int l = 0; l < W; ++l) {
        // A prediction that keeps its limits is the answer.
        if (!task_[l] || over[l] > options_.tolerance) continue;
        std::copy_n(task_[l]->predicted, 3 * g_.vertex_count, task_[l]->position);
        std::fill_n(task_[l]->multiplier, g_.edge_count, 0.0);
        task_[l]->report.status = Status::converged;
        task_[l] = nullptr;
    }
    if (std::any_of(task_.begin(), task_.end(), [](const auto* t) { return t && t->warm; })) recall();
    if (next() < 0) return lap.lap(seconds_.sweep);
    sweep();
    measure_sweeps<W>(g_, penalty, largest.value, over.value);
    for (int l = 0; l < W; ++l)
        mu[l] = std::max(largest[l], 1e-12) * std::clamp(0.2 * over[l], start_.least_centre, 1.0);
    smooth_start<W>(g_, penalty, mu.value);
    lap.lap(seconds_.sweep);
}

template <int W>
void Preparation<W>::sweep() {
    for (int s = 0; s < start_.sweeps; ++s) {
        buffers_.shared.constant->template solve<W>(g_.step);
        finish_sweep<W>(g_, buffers_.shared.penalty);
    }
    for (InextensibilityTask* task : task_)
        if (task) task->report.sweeps += start_.sweeps;
}

/// Starts the sweeps from earlier solutions. One that still is the answer is finished.
template <int W>
void Preparation<W>::recall() {
    for (int l = 0; l < W; ++l) {
        for (int e = 0; e < g_.edge_count; ++e) g_.multiplier[e * W + l] = 0.0;
        if (!task_[l] || !task_[l]->warm) continue;
        buffers_.load_position(l, task_[l]->position);
        buffers_.load_multiplier(l, task_[l]->multiplier);
    }
    InextensibilityMeasure measure;
    measure_solution<W>(g_, measure);
    for (int l = 0; l < W; ++l)
        if (task_[l] && task_[l]->warm && relative_residual(measure, l) <= options_.tolerance)
            finish(buffers_, l, *take(l), Status::converged, 0);
    resume_sweeps<W>(g_, buffers_.shared.penalty);
}

/// The samples that take their steps side by side.
template <int W>
class InteriorPoint {
  public:
    InteriorPoint(InextensibilityBuffers<W>& buffers, const InextensibilityOptions& options, StageSeconds& seconds)
        : buffers_(buffers), g_(buffers.lanes), options_(options), seconds_(seconds) {}

    bool any() const;
    /// Fills the lanes that are free, as far as there are prepared samples.
    void refill(Preparation<W>& preparation);
    bool has_room() const;
    /// One step of every sample; those that have arrived, or cannot, are finished.
    void iterate();

  private:
    void check();
    void step();

    InextensibilityBuffers<W>& buffers_;
    const InextensibilityLanes<W>& g_;
    const InextensibilityOptions& options_;
    StageSeconds& seconds_;
    std::array<InextensibilityTask*, W> task_{};
    std::array<int, W> iteration_{};
    InextensibilityMeasure measure_;
    Lap lap_;
};

template <int W>
bool InteriorPoint<W>::any() const {
    return std::any_of(task_.begin(), task_.end(), [](const auto* t) { return t; });
}
template <int W>
bool InteriorPoint<W>::has_room() const {
    return std::any_of(task_.begin(), task_.end(), [](const auto* t) { return !t; });
}

template <int W>
void InteriorPoint<W>::refill(Preparation<W>& preparation) {
    lap_ = {};
    for (int l = 0; l < W; ++l) {
        const int from = task_[l] ? -1 : preparation.next();
        if (from < 0) continue;
        buffers_.take_lane(l, preparation.buffers(), from);
        task_[l] = preparation.take(from);
        iteration_[l] = 0;
    }
    lap_.lap(seconds_.sweep);
}

template <int W>
void InteriorPoint<W>::check() {
    for (int l = 0; l < W; ++l) {
        if (!task_[l]) continue;
        const double residual = relative_residual(measure_, l);
        if (!std::isfinite(residual)) {
            // Nothing of this lane can be used: its prediction stands, with no forces.
            std::copy_n(task_[l]->predicted, 3 * g_.vertex_count, task_[l]->position);
            std::fill_n(task_[l]->multiplier, g_.edge_count, 0.0);
            task_[l]->report.status = Status::accuracy_not_reached;
            task_[l]->report.iterations = iteration_[l];
            task_[l] = nullptr;
        } else if (residual <= options_.tolerance || iteration_[l] >= options_.max_iterations) {
            const bool arrived = residual <= options_.tolerance;
            finish(buffers_, l, *task_[l], arrived ? Status::converged : Status::accuracy_not_reached, iteration_[l]);
            task_[l] = nullptr;
        }
    }
}

template <int W>
void InteriorPoint<W>::iterate() {
    lap_ = {};
    linearise<W>(g_, measure_);
    check();
    lap_.lap(seconds_.assembly);
    if (any()) step();
    for (int& count : iteration_) ++count;
}

template <int W>
void InteriorPoint<W>::step() {
    PerLane<W> inverse, centre, length, reach, trial_inverse, use_trial;
    const std::bitset<W> good = buffers_.cholesky->factor_and_solve(g_.block, g_.step);
    lap_.lap(seconds_.factor);
    for (int l = 0; l < W; ++l)
        if (task_[l] && !good[l])
            finish(buffers_, l, *std::exchange(task_[l], nullptr), Status::accuracy_not_reached, iteration_[l]);
    measure_affine<W>(g_, inverse.value);
    for (int l = 0; l < W; ++l) {
        const double affine = 1.0 / std::max(inverse[l], 1.0);
        const double rest = 1.0 - affine;
        centre[l] = task_[l] ? rest * rest * rest * measure_.gap[l] : 0.0;
    }
    aim_at_centre<W>(g_, centre.value);
    lap_.lap(seconds_.assembly);
    buffers_.cholesky->solve(g_.step);
    lap_.lap(seconds_.solve);
    measure_step<W>(g_, false, inverse.value);
    bool short_step = false;
    for (int l = 0; l < W; ++l) {
        length[l] = 1.0 / std::max(inverse[l], 1.0);
        reach[l] = std::min(1.0, std::max(1.5 * length[l], length[l] + 0.3));
        short_step = short_step || (task_[l] && length[l] < 0.95);
    }
    if (short_step) {
        aim_at_products<W>(g_, reach.value, centre.value);
        lap_.lap(seconds_.assembly);
        buffers_.cholesky->solve(g_.trial);
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
        length[l] = task_[l] ? std::min(1.0, (1.0 - short_of) * length[l]) : 0.0;
        if (!std::isfinite(length[l])) length[l] = 0.0;
    }
    advance<W>(g_, length.value, use_trial.value);
    lap_.lap(seconds_.assembly);
}

}  // namespace

template <int W>
void project_samples(InextensibilityBuffers<W>& solving, InextensibilityBuffers<W>& waiting,
                     std::span<InextensibilityTask> task, const InextensibilityOptions& options,
                     const InteriorPointStart& start, StageSeconds& seconds) {
    Preparation<W> preparation(waiting, options, start, seconds);
    solving.make_matrix();
    InteriorPoint<W> interior_point(solving, options, seconds);
    while (true) {
        while (interior_point.has_room() && (preparation.next() >= 0 || !task.empty())) {
            if (preparation.next() < 0) {
                const std::size_t count = std::min<std::size_t>(W, task.size());
                preparation.prepare(task.first(count));
                task = task.subspan(count);
            }
            interior_point.refill(preparation);
        }
        if (!interior_point.any()) return;
        interior_point.iterate();
    }
}

template void project_samples<1>(InextensibilityBuffers<1>&, InextensibilityBuffers<1>&, std::span<InextensibilityTask>,
                                 const InextensibilityOptions&, const InteriorPointStart&, StageSeconds&);
template void project_samples<8>(InextensibilityBuffers<8>&, InextensibilityBuffers<8>&, std::span<InextensibilityTask>,
                                 const InextensibilityOptions&, const InteriorPointStart&, StageSeconds&);

}  // namespace toile::prior
