#include "prior/inextensibility.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "prior/cone_solver.h"
#include "prior/inextensibility_derivative.h"
#include "prior/interior_point.h"

namespace toile::prior {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_model(const InextensibilityModel& model) {
    if (model.vertex_count < 1) throw Error("the inextensibility prior needs at least one vertex");
    if (model.edge_max_length.size() != model.edge.rows() || model.target_stiffness.size() != model.vertex_count)
        throw Error("the inextensibility model's arrays do not fit each other: " + std::to_string(model.edge.rows()) +
                    " edges, " + std::to_string(model.edge_max_length.size()) + " limits, " +
                    std::to_string(model.vertex_count) + " vertices, " + std::to_string(model.target_stiffness.size()) +
                    " target stiffnesses");
    for (Eigen::Index e = 0; e < model.edge.rows(); ++e) {
        const int a = model.edge(e, 0), b = model.edge(e, 1);
        if (a < 0 || b < 0 || a >= model.vertex_count || b >= model.vertex_count || a == b)
            throw Error("edge " + std::to_string(e) + " joins vertices " + std::to_string(a) + " and " +
                        std::to_string(b) + " of " + std::to_string(model.vertex_count));
        if (!(model.edge_max_length[e] > 0) || !std::isfinite(model.edge_max_length[e]))
            throw Error("the limit of edge " + std::to_string(e) + " is " + std::to_string(model.edge_max_length[e]) +
                        ": it must be positive");
    }
    for (Eigen::Index v = 0; v < model.target_stiffness.size(); ++v)
        if (!(model.target_stiffness[v] > 0) || !std::isfinite(model.target_stiffness[v]))
            throw Error("the target stiffness of vertex " + std::to_string(v) + " is " +
                        std::to_string(model.target_stiffness[v]) + ": it must be positive");
}

}  // namespace

InextensibilityModel InextensibilityModel::from(const RestState& rest, double stretch_limit) {
    if (!(stretch_limit > -1) || !std::isfinite(stretch_limit))
        throw Error("stretch_limit is " + std::to_string(stretch_limit) + ": it must be above -1");
    return {rest.vertex_count, rest.edge, (1 + stretch_limit) * rest.edge_rest_length, rest.mass / rest.mass.mean()};
}

void InextensibilityOptions::validate() const {
    if (!(tolerance >= 1e-10 && tolerance <= 1e-1))
        throw Error("tolerance is " + std::to_string(tolerance) + ": it must lie in [1e-10, 0.1]");
    if (max_iterations < 1)
        throw Error("max_iterations is " + std::to_string(max_iterations) + ": it must be at least 1");
}

struct Inextensibility::Impl {
    Impl(InextensibilityModel given, const InextensibilityOptions& chosen)
        : model(std::move(given)), options(chosen), shared(model), cone(model) {}

    InextensibilityModel model;
    InextensibilityOptions options;
    InextensibilityShared shared;
    ConeSolver cone;
};

namespace {

/// Samples being solved, and those prepared to take their places.
template <int W>
struct LanePair {
    explicit LanePair(const InextensibilityShared& shared) : solving(shared), waiting(shared) {}
    InextensibilityBuffers<W> solving, waiting;
    std::vector<InextensibilityTask> task;
};

}  // namespace

struct Inextensibility::Workspace::Buffers {
    /// One thread's storage, made when it is first needed.
    struct Slot {
        std::unique_ptr<LanePair<1>> one;
        std::unique_ptr<LanePair<8>> eight;
        std::unique_ptr<ConeSolver::Workspace> cone;
    };
    std::vector<Slot> slot;

    ConeSolver::Workspace& get_cone(int index, const ConeSolver& solver) {
        if (!slot[index].cone) slot[index].cone = std::make_unique<ConeSolver::Workspace>(solver);
        return *slot[index].cone;
    }

    template <int W>
    LanePair<W>& get(int index, const InextensibilityShared& shared) {
        auto& pointer = [ this, index ]() -> auto& {
            if constexpr (W == 1)
                return slot[index].one;
            else
                return slot[index].eight;
        }
        ();
        if (!pointer || &pointer->solving.shared != &shared) pointer = std::make_unique<LanePair<W>>(shared);
        return *pointer;
    }
};

Inextensibility::Workspace::Workspace(const Inextensibility&, int threads) : buffers_(std::make_unique<Buffers>()) {
    if (threads < 1) throw Error("a workspace needs at least one thread, not " + std::to_string(threads));
    buffers_->slot.resize(threads);
}
Inextensibility::Workspace::~Workspace() = default;
Inextensibility::Workspace::Workspace(Workspace&&) noexcept = default;

Inextensibility::Inextensibility(InextensibilityModel model, const InextensibilityOptions& options) {
    check_model(model);
    options.validate();
    impl_ = std::make_unique<Impl>(std::move(model), options);
}
Inextensibility::~Inextensibility() = default;
Inextensibility::Inextensibility(Inextensibility&&) noexcept = default;

const InextensibilityModel& Inextensibility::model() const {
    return impl_->model;
}
const InextensibilityOptions& Inextensibility::options() const {
    return impl_->options;
}

void Inextensibility::set_edge_max_length(const Eigen::VectorXd& edge_max_length) {
    InextensibilityModel model = impl_->model;
    model.edge_max_length = edge_max_length;
    check_model(model);
    impl_->model = std::move(model);
    impl_->shared.scale(impl_->model);
    impl_->cone.set_edge_max_length(impl_->model.edge_max_length);
}

namespace {

/// One batch on its way through `project`.
struct Batch {
    const InextensibilityModel& model;
    const InextensibilityShared& shared;
    const ConeSolver& cone;
    InextensibilityOptions options;
    std::span<const double> predicted;
    InextensibilitySolution& solution;
    bool warm;

    std::size_t positions() const { return 3 * static_cast<std::size_t>(model.vertex_count); }
    std::size_t edges() const { return static_cast<std::size_t>(model.edge.rows()); }
    InextensibilityTask task(int sample) const {
        InextensibilityTask lane;
        lane.predicted = predicted.data() + sample * positions();
        lane.position = solution.position.data() + sample * positions();
        lane.multiplier = solution.multiplier.data() + sample * edges();
        lane.warm = warm && solution.report[sample].status != Status::rejected_input;
        return lane;
    }
};

void share_time(Report& report, const StageSeconds& seconds, double total, int samples) {
    report.seconds += total / samples;
    report.seconds_sweep += seconds.sweep / samples;
    report.seconds_assembly += seconds.assembly / samples;
    report.seconds_factor += seconds.factor / samples;
    report.seconds_solve += seconds.solve / samples;
}

/// The residual of what was written, in the sample's own units and place: what is reported is this one.
void report_residual(const Batch& batch, int sample) {
    Report& report = batch.solution.report[sample];
    if (report.status == Status::rejected_input) return;
    const InextensibilityTask lane = batch.task(sample);
    report.residual = inextensibility_residual(batch.model, {lane.predicted, batch.positions()},
                                               {lane.position, batch.positions()}, {lane.multiplier, batch.edges()});
    report.status = report.residual <= batch.options.tolerance ? Status::converged : Status::accuracy_not_reached;
}

/// Samples [begin, begin + count), W at a time.
template <int W>
void project_lanes(const Batch& batch, LanePair<W>& buffers, int begin, int count) {
    const Clock::time_point start = Clock::now();
    buffers.task.clear();
    for (int s = begin; s < begin + count; ++s) buffers.task.push_back(batch.task(s));
    StageSeconds seconds;
    // A sample that takes much longer than others is solved alone afterwards, instead of in everybody's time.
    InextensibilityOptions options = batch.options;
    options.max_iterations = std::min(options.max_iterations, 40);
    InteriorPointStart way;
    // A factorisation costs a sample alone less than eight at once, and a sweep more.
    if (W == 1) way.sweeps = 10;
    project_samples<W>(buffers.solving, buffers.waiting, buffers.task, options, way, seconds);
    for (int s = 0; s < count; ++s) {
        batch.solution.report[begin + s] = buffers.task[s].report;
        report_residual(batch, begin + s);
    }
    const double total = seconds_since(start);
    for (int s = begin; s < begin + count; ++s) share_time(batch.solution.report[s], seconds, total, count);
}

/// For a sample that the quick way did not bring to its tolerance: from further inside with more sweeps, then by the
/// cone program. Keeps the best.
void project_again(const Batch& batch, LanePair<1>& buffers, ConeSolver::Workspace& cone, int sample) {
    const Clock::time_point start = Clock::now();
    Report& report = batch.solution.report[sample];
    const Report quick = report;
    const InextensibilityTask out = batch.task(sample);
    std::vector<double> best_position(out.position, out.position + batch.positions());
    std::vector<double> best_multiplier(out.multiplier, out.multiplier + batch.edges());
    double best = quick.residual;
    StageSeconds seconds;
    int iterations = quick.iterations, sweeps = quick.sweeps;
    const auto keep_best = [&](const Report& attempt) {
        iterations += attempt.iterations;
        sweeps += attempt.sweeps;
        report = attempt;
        report_residual(batch, sample);
        if (!(report.residual < best)) return;
        best = report.residual;
        std::copy_n(out.position, batch.positions(), best_position.data());
        std::copy_n(out.multiplier, batch.edges(), best_multiplier.data());
    };
    InextensibilityTask again = out;
    again.warm = false;
    project_samples<1>(buffers.solving, buffers.waiting, {&again, 1}, batch.options, {50, 1.0}, seconds);
    keep_best(again.report);
    if (!(best <= batch.options.tolerance))
        keep_best(batch.cone.project({out.predicted, batch.positions()}, {out.position, batch.positions()},
                                     {out.multiplier, batch.edges()}, batch.options, cone));
    std::copy(best_position.begin(), best_position.end(), out.position);
    std::copy(best_multiplier.begin(), best_multiplier.end(), out.multiplier);
    report.residual = best;
    report.status = best <= batch.options.tolerance ? Status::converged : Status::accuracy_not_reached;
    report.iterations = iterations;
    report.sweeps = sweeps;
    report.seconds = quick.seconds;
    share_time(report, seconds, seconds_since(start), 1);
}

}  // namespace

void Inextensibility::project(std::span<const double> predicted, InextensibilitySolution& solution,
                              Workspace& workspace, bool warm_start) const {
    const InextensibilityModel& model = impl_->model;
    const std::size_t positions = 3 * static_cast<std::size_t>(model.vertex_count), edges = model.edge.rows();
    if (predicted.size() % positions != 0)
        throw Error("predicted positions have " + std::to_string(predicted.size()) +
                    " numbers: not a multiple of 3 x " + std::to_string(model.vertex_count) + " vertices");
    const int count = static_cast<int>(predicted.size() / positions);
    if (warm_start && (solution.position.size() != count * positions || solution.multiplier.size() != count * edges ||
                       solution.report.size() != static_cast<std::size_t>(count)))
        throw Error("the solution to start from is not one of these " + std::to_string(count) + " samples");
    solution.position.resize(count * positions);
    solution.multiplier.resize(count * edges);
    solution.report.resize(count);

    const Batch batch{model, impl_->shared, impl_->cone, impl_->options, predicted, solution, warm_start};
    auto& slots = workspace.buffers_->slot;
    const int threads = static_cast<int>(slots.size());
    if (impl_->options.method == InextensibilityOptions::Method::cone) {
        parallel_for(count, threads, [&](int slot, int sample) {
            const InextensibilityTask lane = batch.task(sample);
            solution.report[sample] =
                impl_->cone.project({lane.predicted, positions}, {lane.position, positions}, {lane.multiplier, edges},
                                    impl_->options, workspace.buffers_->get_cone(slot, impl_->cone));
        });
        return;
    }
    if (count == 1) {
        project_lanes<1>(batch, workspace.buffers_->get<1>(0, impl_->shared), 0, 1);
    } else {
        // Each thread has one share, as long as shares are large enough to keep its lanes full.
        const int share = 8 * std::max(1, (count + 8 * threads - 1) / (8 * threads));
        parallel_for((count + share - 1) / share, threads, [&](int slot, int part) {
            project_lanes<8>(batch, workspace.buffers_->get<8>(slot, impl_->shared), share * part,
                             std::min(share, count - share * part));
        });
    }
    parallel_for(count, threads, [&](int slot, int sample) {
        if (solution.report[sample].status == Status::accuracy_not_reached)
            project_again(batch, workspace.buffers_->get<1>(slot, impl_->shared),
                          workspace.buffers_->get_cone(slot, impl_->cone), sample);
    });
}

namespace {

/// Differentiates samples [begin, begin + report.size()), at most W, side by side. `aim` says of a sample what is to be
/// multiplied and where results go.
template <int W, typename Aim>
void differentiate(InextensibilityBuffers<W>& buffers, const InextensibilitySolution& solution, int begin,
                   double tolerance, std::span<DerivativeReport> report, const Aim& aim) {
    const Clock::time_point start = Clock::now();
    const std::size_t positions = 3 * static_cast<std::size_t>(buffers.shared.vertex_count);
    const std::size_t edges = buffers.shared.edge_count;
    std::array<InextensibilityDerivativeLane, W> lane;
    for (std::size_t l = 0; l < report.size(); ++l) {
        const std::size_t s = begin + l;
        lane[l].position = solution.position.data() + s * positions;
        lane[l].multiplier = solution.multiplier.data() + s * edges;
        aim(s, lane[l]);
    }
    differentiate_group<W>(buffers, lane, tolerance);
    const double each = seconds_since(start) / static_cast<double>(report.size());
    for (std::size_t l = 0; l < report.size(); ++l) {
        report[l] = lane[l].report;
        report[l].seconds = each;
    }
}

/// The same for a whole batch: one sample alone, or eight at a time.
template <typename Buffers, typename Aim>
void differentiate_batch(const InextensibilityShared& shared, double tolerance, Buffers& buffers,
                         const InextensibilitySolution& solution, std::span<DerivativeReport> report, const Aim& aim) {
    const int count = static_cast<int>(report.size());
    if (count == 1)
        return differentiate<1>(buffers.template get<1>(0, shared).solving, solution, 0, tolerance, report, aim);
    parallel_for((count + 7) / 8, static_cast<int>(buffers.slot.size()), [&](int slot, int group) {
        differentiate<8>(buffers.template get<8>(slot, shared).solving, solution, 8 * group, tolerance,
                         report.subspan(8 * group, std::min(8, count - 8 * group)), aim);
    });
}

int check_solution(const InextensibilityModel& model, const InextensibilitySolution& solution) {
    const std::size_t count = solution.report.size();
    if (solution.position.size() != 3 * count * model.vertex_count ||
        solution.multiplier.size() != count * model.edge.rows())
        throw Error("the solution to differentiate at is not one of this mesh");
    return static_cast<int>(count);
}

void check_size(std::size_t size, std::size_t wanted, const std::string& name) {
    if (size != wanted)
        throw Error(name + " has " + std::to_string(size) + " numbers where the solution asks for " +
                    std::to_string(wanted));
}

}  // namespace

void Inextensibility::backward(const InextensibilitySolution& solution, std::span<const double> loss_gradient,
                               InextensibilityGradient& gradient, Workspace& workspace) const {
    const int count = check_solution(impl_->model, solution);
    check_size(loss_gradient.size(), solution.position.size(), "the loss gradient");
    const std::size_t positions = 3 * static_cast<std::size_t>(impl_->model.vertex_count);
    const std::size_t edges = impl_->model.edge.rows();
    gradient.predicted.resize(count * positions);
    gradient.edge_max_length.resize(count * edges);
    gradient.report.resize(count);
    auto& slots = *workspace.buffers_;
    if (impl_->options.method == InextensibilityOptions::Method::cone) {
        parallel_for(count, static_cast<int>(slots.slot.size()), [&](int, int s) {
            gradient.report[s] = impl_->cone.backward(
                {solution.position.data() + s * positions, positions}, {solution.multiplier.data() + s * edges, edges},
                loss_gradient.subspan(s * positions, positions), {gradient.predicted.data() + s * positions, positions},
                {gradient.edge_max_length.data() + s * edges, edges});
        });
        return;
    }
    differentiate_batch(impl_->shared, impl_->options.tolerance, slots, solution, gradient.report,
                        [&](std::size_t s, InextensibilityDerivativeLane& lane) {
                            lane.loss_gradient = loss_gradient.data() + s * positions;
                            lane.result = gradient.predicted.data() + s * positions;
                            lane.multiplier_result = gradient.edge_max_length.data() + s * edges;
                        });
}

void Inextensibility::tangent(const InextensibilitySolution& solution, std::span<const double> predicted_change,
                              std::span<const double> edge_max_length_change, InextensibilityTangent& tangent,
                              Workspace& workspace) const {
    const int count = check_solution(impl_->model, solution);
    check_size(predicted_change.size(), solution.position.size(), "the change of the prediction");
    if (!edge_max_length_change.empty())
        check_size(edge_max_length_change.size(), solution.multiplier.size(), "the change of the limits");
    const std::size_t positions = 3 * static_cast<std::size_t>(impl_->model.vertex_count);
    const std::size_t edges = impl_->model.edge.rows();
    tangent.position.resize(count * positions);
    tangent.report.resize(count);
    auto& slots = *workspace.buffers_;
    if (impl_->options.method == InextensibilityOptions::Method::cone) {
        parallel_for(count, static_cast<int>(slots.slot.size()), [&](int, int s) {
            tangent.report[s] = impl_->cone.tangent(
                {solution.position.data() + s * positions, positions}, {solution.multiplier.data() + s * edges, edges},
                predicted_change.subspan(s * positions, positions),
                edge_max_length_change.empty() ? edge_max_length_change
                                               : edge_max_length_change.subspan(s * edges, edges),
                {tangent.position.data() + s * positions, positions});
        });
        return;
    }
    differentiate_batch(impl_->shared, impl_->options.tolerance, slots, solution, tangent.report,
                        [&](std::size_t s, InextensibilityDerivativeLane& lane) {
                            lane.predicted_change = predicted_change.data() + s * positions;
                            if (!edge_max_length_change.empty())
                                lane.limit_change = edge_max_length_change.data() + s * edges;
                            lane.result = tangent.position.data() + s * positions;
                        });
}

InextensibilitySolution project_inextensible(const ClothMesh& mesh, const Positions& predicted, double stretch_limit,
                                             const InextensibilityOptions& options) {
    const Inextensibility prior(InextensibilityModel::from(rest_state(mesh), stretch_limit), options);
    Inextensibility::Workspace workspace(prior);
    InextensibilitySolution solution;
    prior.project({predicted.data(), static_cast<std::size_t>(predicted.size())}, solution, workspace);
    return solution;
}

}  // namespace toile::prior
