#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include "cloth/error.h"
#include "prior/derivative_lanes.h"
#include "prior/incomplete_cholesky.h"
#include "prior/quasistatic_impl.h"
#include "prior/single_preconditioners.h"
#include "prior/spring_lanes.h"

namespace toile::prior {
namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check_size(size_t size, size_t wanted, const char* what) {
    if (size != wanted) throw Error(std::string("the ") + what + " has the wrong size for this batch");
}

/// What both products know of a batch.
struct Batch {
    const QuasistaticModel& model;
    const SpringGraph& graph;
    const double* predicted;  // [N x V x 3]
    const double* position;   // [N x V x 3]

    size_t size() const { return 3 * static_cast<size_t>(model.vertex_count); }
};

/// ∂L/∂r* in, ∂L/∂(inputs) out.
struct BackwardTask {
    const Batch& batch;
    const double* loss_gradient;
    QuasistaticGradient& out;

    DerivativeReport& report(int sample) const { return out.report[sample]; }

    template <int W>
    bool begin(DerivativeLanes<W>& lanes, int lane, int sample) const {
        return lanes.set_right_side(lane, loss_gradient + batch.size() * sample);
    }
    template <int W>
    void prepare(DerivativeLanes<W>&, const int*, int) const {}

    void reject(int sample) const {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        const auto i = static_cast<size_t>(sample);
        std::fill_n(out.predicted.begin() + static_cast<std::ptrdiff_t>(i * batch.size()), batch.size(), nan);
        std::fill_n(out.mu_vertex.begin() + static_cast<std::ptrdiff_t>(i * batch.size() / 3), batch.size() / 3, nan);
        out.mu[i] = out.stretch[i] = out.bending[i] = out.axial[i] = nan;
    }

    template <int W>
    void finish(const DerivativeLanes<W>& lanes, const int* sample, int count) const {
        alignas(64) double moduli[3 * W];
        dot_moduli<W>(batch.graph, lanes.position(), lanes.solution(), moduli);
        for (int l = 0; l < count; ++l) {
            if (!lanes.loaded(l)) continue;
            const auto i = static_cast<size_t>(sample[l]);
            finish_vertices(lanes, l, i);
            out.stretch[i] = -batch.graph.length_unit * moduli[l];
            out.bending[i] = -batch.graph.length_unit * moduli[W + l];
            out.axial[i] = -batch.graph.length_unit * moduli[2 * W + l];
        }
    }

    template <int W>
    void finish_vertices(const DerivativeLanes<W>& lanes, int l, size_t i) const {
        const SpringGraph& graph = batch.graph;
        double* predicted = out.predicted.data() + batch.size() * i;
        double* mu_vertex = out.mu_vertex.data() + batch.size() / 3 * i;
        for (int v = 0; v < graph.vertex_count; ++v) {
            const int vertex = graph.vertex[v];
            double pull = 0.0;
            for (int c = 0; c < 3; ++c) {
                const size_t at = static_cast<size_t>(3 * v + c) * W + static_cast<size_t>(l);
                const double eta = lanes.solution()[at];
                predicted[3 * vertex + c] = graph.target[v] * eta;
                pull += eta * (lanes.predicted()[at] - lanes.position()[at]);
            }
            mu_vertex[vertex] = graph.length_unit / graph.stiffness_unit * batch.model.target_unit[vertex] * pull;
        }
        double sum = 0.0;
        for (int v = 0; v < graph.vertex_count; ++v) sum += mu_vertex[v];
        out.mu[i] = sum;
    }
};

/// A change of the inputs in, the change of r* out.
struct TangentTask {
    const Batch& batch;
    const QuasistaticChange& change;
    QuasistaticTangent& out;

    DerivativeReport& report(int sample) const { return out.report[sample]; }

    template <int W>
    bool begin(DerivativeLanes<W>& lanes, int lane, int sample) const {
        const SpringGraph& graph = batch.graph;
        const auto i = static_cast<size_t>(sample);
        bool finite = true;
        for (int v = 0; v < graph.vertex_count; ++v) {
            const auto vertex = static_cast<size_t>(graph.vertex[v]);
            const double mu = change.mu_vertex.empty() ? 0.0 : change.mu_vertex[batch.size() / 3 * i + vertex];
            const double k = graph.length_unit / graph.stiffness_unit * batch.model.target_unit[graph.vertex[v]] * mu;
            for (int c = 0; c < 3; ++c) {
                const size_t at = static_cast<size_t>(3 * v + c) * W + static_cast<size_t>(lane);
                const double move =
                    change.predicted.empty() ? 0.0 : change.predicted[batch.size() * i + 3 * vertex + c];
                lanes.right_side()[at] = graph.target[v] * move + k * (lanes.predicted()[at] - lanes.position()[at]);
                finite &= std::isfinite(lanes.right_side()[at]);
            }
        }
        return finite;
    }

    /// −δk ∂(gradient)/∂k of the three moduli.
    template <int W>
    void prepare(DerivativeLanes<W>& lanes, const int* sample, int count) const {
        if (change.stretch.empty() && change.bending.empty() && change.axial.empty()) return;
        alignas(64) double factor[3 * W] = {};
        const std::span<const double> moduli[3] = {change.stretch, change.bending, change.axial};
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < count; ++l)
                if (lanes.loaded(l) && !moduli[k].empty())
                    factor[W * k + l] = -batch.graph.length_unit * moduli[k][static_cast<size_t>(sample[l])];
        add_moduli<W>(batch.graph, lanes.position(), factor, lanes.right_side());
    }

    void reject(int sample) const {
        const auto first = out.position.begin() + static_cast<std::ptrdiff_t>(batch.size()) * sample;
        std::fill_n(first, batch.size(), std::numeric_limits<double>::quiet_NaN());
    }

    template <int W>
    void finish(const DerivativeLanes<W>& lanes, const int* sample, int count) const {
        for (int l = 0; l < count; ++l) {
            if (!lanes.loaded(l)) continue;
            double* position = out.position.data() + batch.size() * static_cast<size_t>(sample[l]);
            for (int v = 0; v < batch.graph.vertex_count; ++v)
                for (int c = 0; c < 3; ++c)
                    position[3 * batch.graph.vertex[v] + c] =
                        lanes.solution()[static_cast<size_t>(3 * v + c) * W + static_cast<size_t>(l)];
        }
    }
};

/// Samples `[count]` of a batch, side by side.
template <int W, class Task>
void solve_group(DerivativeLanes<W>& lanes, const Task& task, const int* sample, int count) {
    const double begin = now();
    lanes.clear();
    for (int l = 0; l < count; ++l) {
        const size_t first = task.batch.size() * static_cast<size_t>(sample[l]);
        task.report(sample[l]) = DerivativeReport{};
        const bool loaded = lanes.load(l, task.batch.predicted + first, task.batch.position + first);
        if (loaded && !task.begin(lanes, l, sample[l])) lanes.unload(l);
        if (!lanes.loaded(l)) task.reject(sample[l]);
    }
    task.prepare(lanes, sample, count);
    lanes.factor();
    lanes.solve();
    task.finish(lanes, sample, count);
    const double share = (now() - begin) / count;
    for (int l = 0; l < count; ++l) {
        DerivativeReport& report = task.report(sample[l]);
        if (lanes.loaded(l)) report = lanes.report(l);
        report.seconds = share;
    }
}

template <int W>
DerivativeLanes<W>& fast_lanes(std::unique_ptr<DerivativeLanes<W>>& kept, const SpringGraph& graph) {
    if (!kept) {
        std::unique_ptr<LinearSweeps<W>> sweeps = fast_sweeps<W>(graph);
        kept = std::make_unique<DerivativeLanes<W>>(graph, std::move(sweeps), DerivativeRules{});
    }
    return *kept;
}

/// In double precision, with the complete factor: for systems that are stiff, or not positive definite.
DerivativeLanes<1>& last_resort(std::unique_ptr<DerivativeLanes<1>>& kept, const SpringGraph& graph) {
    if (!kept) {
        auto sweeps = std::make_unique<DoubleSweeps<1>>(graph, std::make_unique<CompleteCholesky>(graph));
        DerivativeRules rules;
        rules.reduction = 1e-12;
        rules.complete_factor = true;
        kept = std::make_unique<DerivativeLanes<1>>(graph, std::move(sweeps), rules);
    }
    return *kept;
}

template <class Task>
void solve_batch(const Task& task, int count, Quasistatic::Workspace::Buffers& buffers) {
    const SpringGraph& graph = task.batch.graph;
    const int width = count == 1 ? 1 : 8, groups = (count + width - 1) / width;
    std::atomic<int> next{0};
    const auto work = [&](int slot) {
        for (int group = next++; group < groups; group = next++) {
            int sample[8];
            const int first = group * width, in_group = std::min(width, count - first);
            for (int l = 0; l < in_group; ++l) sample[l] = first + l;
            if (width == 1)
                solve_group(fast_lanes<1>(buffers.derivative_one[slot], graph), task, sample, in_group);
            else
                solve_group(fast_lanes<8>(buffers.derivative_eight[slot], graph), task, sample, in_group);
        }
    };
    on_threads(std::clamp(groups, 1, buffers.threads), std::cref(work));
    for (int i = 0; i < count; ++i) {
        if (task.report(i).status != Status::accuracy_not_reached) continue;
        const double before = task.report(i).seconds;
        solve_group(last_resort(buffers.derivative_last_resort, graph), task, &i, 1);
        task.report(i).seconds += before;
    }
}

}  // namespace

void Quasistatic::backward(std::span<const double> predicted, const QuasistaticSolution& solution,
                           std::span<const double> loss_gradient, QuasistaticGradient& gradient,
                           Workspace& workspace) const {
    const int count = workspace.buffers_->check(*impl_, predicted, solution);
    const size_t samples = static_cast<size_t>(count);
    check_size(loss_gradient.size(), predicted.size(), "loss gradient");
    gradient.predicted.resize(predicted.size());
    gradient.mu_vertex.resize(predicted.size() / 3);
    for (std::vector<double>* one : {&gradient.mu, &gradient.stretch, &gradient.bending, &gradient.axial})
        one->resize(samples);
    gradient.report.resize(samples);
    const Batch batch{impl_->model, impl_->graph, predicted.data(), solution.position.data()};
    solve_batch(BackwardTask{batch, loss_gradient.data(), gradient}, count, *workspace.buffers_);
}

void Quasistatic::tangent(std::span<const double> predicted, const QuasistaticSolution& solution,
                          const QuasistaticChange& change, QuasistaticTangent& tangent, Workspace& workspace) const {
    const int count = workspace.buffers_->check(*impl_, predicted, solution);
    const auto check = [](std::span<const double> part, size_t wanted, const char* what) {
        if (!part.empty()) check_size(part.size(), wanted, what);
    };
    check(change.predicted, predicted.size(), "change of the predicted positions");
    check(change.mu_vertex, predicted.size() / 3, "change of mu");
    check(change.stretch, static_cast<size_t>(count), "change of the stretch stiffness");
    check(change.bending, static_cast<size_t>(count), "change of the bending stiffness");
    check(change.axial, static_cast<size_t>(count), "change of the axial stiffness");
    tangent.position.resize(predicted.size());
    tangent.report.resize(static_cast<size_t>(count));
    const Batch batch{impl_->model, impl_->graph, predicted.data(), solution.position.data()};
    solve_batch(TangentTask{batch, change, tangent}, count, *workspace.buffers_);
}

}  // namespace toile::prior
