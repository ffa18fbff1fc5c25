#include "prior/quasistatic.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "prior/incomplete_cholesky.h"
#include "prior/newton_lanes.h"
#include "prior/quasistatic_impl.h"
#include "prior/single_preconditioners.h"

namespace toile::prior {
namespace {

void check_springs(const Edges& spring, const Eigen::VectorXd& stiffness, const Eigen::VectorXd& rest_length,
                   int vertex_count, const std::string& what) {
    if (stiffness.size() != spring.rows() || rest_length.size() != spring.rows())
        throw Error("the " + what + "s, their stiffnesses and rest lengths differ in number");
    for (Eigen::Index e = 0; e < spring.rows(); ++e) {
        const std::string name = what + " " + std::to_string(e);
        if (std::min(spring(e, 0), spring(e, 1)) < 0 || std::max(spring(e, 0), spring(e, 1)) >= vertex_count)
            throw Error(name + " names a vertex that is not there");
        if (spring(e, 0) == spring(e, 1)) throw Error(name + " joins a vertex to itself");
        if (!(stiffness[e] >= 0.0) || !std::isfinite(stiffness[e])) throw Error(name + " has a stiffness below zero");
        if (!(rest_length[e] >= 0.0) || !std::isfinite(rest_length[e]))
            throw Error(name + " has a rest length below zero");
    }
}

void check_positive(const Eigen::VectorXd& value, int count, const std::string& what) {
    if (value.size() != count) throw Error("there must be one " + what + " for each vertex");
    for (int i = 0; i < count; ++i)
        if (!(value[i] > 0.0) || !std::isfinite(value[i]))
            throw Error("the " + what + " of vertex " + std::to_string(i) + " is not positive");
}

QuasistaticModel checked(QuasistaticModel model) {
    const int n = model.vertex_count;
    if (n < 1) throw Error("a quasistatic model needs vertices");
    check_springs(model.edge_spring, model.edge_stiffness, model.edge_rest_length, n, "edge spring");
    check_springs(model.bending_spring, model.bending_stiffness, model.bending_rest_length, n, "bending spring");
    const Eigen::Index axial = model.axial_spring.rows();
    if (model.axial_weight.rows() != axial || model.axial_stiffness.size() != axial)
        throw Error("the axial springs, their weights and stiffnesses differ in number");
    for (Eigen::Index e = 0; e < axial; ++e) {
        const auto corner = model.axial_spring.row(e);
        if (corner.minCoeff() < 0 || corner.maxCoeff() >= n)
            throw Error("axial spring " + std::to_string(e) + " names a vertex that is not there");
        if (!model.axial_weight.row(e).allFinite() || !(model.axial_stiffness[e] >= 0.0) ||
            !std::isfinite(model.axial_stiffness[e]))
            throw Error("axial spring " + std::to_string(e) + " has a weight or stiffness that makes no sense");
    }
    check_positive(model.target_stiffness, n, "target stiffness");
    check_positive(model.target_unit, n, "target stiffness at mu = 1");
    return model;
}

/// A rough measure of how far a prediction is from rest: a few springs' squared strains.
double distance_from_rest(const QuasistaticModel& model, const double* position) {
    constexpr Eigen::Index every = 16;
    double sum = 0.0;
    for (Eigen::Index e = 0; e < model.edge_spring.rows(); e += every) {
        const Eigen::Map<const Eigen::Vector3d> a(position + 3 * model.edge_spring(e, 0));
        const Eigen::Map<const Eigen::Vector3d> b(position + 3 * model.edge_spring(e, 1));
        sum += std::pow((a - b).norm() - model.edge_rest_length[e], 2);
    }
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

NewtonRules rules_of(const QuasistaticOptions& options) {
    NewtonRules rules;
    rules.tolerance = options.tolerance;
    rules.max_iterations = options.max_iterations;
    if (options.method == QuasistaticOptions::Method::newton_cg) {
        rules.exact_hessian = false;
        rules.max_sweeps = 10000;
        rules.max_slow_steps = options.max_iterations + 1;
        rules.loosest_forcing = 1e-2;
    }
    return rules;
}

/// Rules of the last resort: with the complete factor no step is slow.
NewtonRules rules_of_last_resort(const QuasistaticOptions& options) {
    NewtonRules rules = rules_of(options);
    rules.max_slow_steps = options.max_iterations + 1;
    return rules;
}

}  // namespace

Quasistatic::Impl::Impl(QuasistaticModel given, const QuasistaticOptions& chosen)
    : model(checked(std::move(given))), options(chosen), graph(model) {
    options.validate();
}

Quasistatic::Quasistatic(QuasistaticModel model, const QuasistaticOptions& options)
    : impl_(std::make_unique<Impl>(std::move(model), options)) {}
Quasistatic::~Quasistatic() = default;
Quasistatic::Quasistatic(Quasistatic&&) noexcept = default;

const QuasistaticModel& Quasistatic::model() const {
    return impl_->model;
}
const QuasistaticOptions& Quasistatic::options() const {
    return impl_->options;
}

void Quasistatic::set_mu(const Eigen::VectorXd& mu_vertex) {
    check_positive(mu_vertex, impl_->model.vertex_count, "mu");
    impl_->model.target_stiffness = mu_vertex.cwiseProduct(impl_->model.target_unit);
    impl_->graph.set_target(impl_->model);
}

Quasistatic::Workspace::Workspace(const Quasistatic& prior, int threads)
    : buffers_(std::make_unique<Buffers>(*prior.impl_, threads)) {}
Quasistatic::Workspace::~Workspace() = default;
Quasistatic::Workspace::Workspace(Workspace&&) noexcept = default;

Quasistatic::Workspace::Buffers::Buffers(const Quasistatic::Impl& owner, int thread_count)
    : prior(&owner),
      threads(thread_count),
      eight(static_cast<size_t>(thread_count)),
      one(static_cast<size_t>(thread_count)),
      last_resort(static_cast<size_t>(thread_count)),
      derivative_eight(static_cast<size_t>(thread_count)),
      derivative_one(static_cast<size_t>(thread_count)) {
    if (thread_count < 1) throw Error("a workspace needs at least one thread");
}

int Quasistatic::Workspace::Buffers::check(const Quasistatic::Impl& owner, std::span<const double> predicted,
                                           const QuasistaticSolution& solution) const {
    const size_t size = 3 * static_cast<size_t>(owner.model.vertex_count);
    if (prior != &owner) throw Error("the workspace belongs to another quasistatic prior");
    if (predicted.size() % size != 0) throw Error("the predicted positions do not fit the model's vertices");
    if (solution.position.size() != predicted.size()) throw Error("the solution does not fit the predicted positions");
    return static_cast<int>(predicted.size() / size);
}

void on_threads(int threads, const std::function<void(int)>& task) {
    if (threads == 1)
        task(0);
    else
        parallel_for(threads, threads, [&](int, int index) { task(index); });
}

namespace {

template <int W>
NewtonLanes<W>& fast_solver(std::unique_ptr<NewtonLanes<W>>& kept, const Quasistatic::Impl& prior) {
    if (!kept) {
        std::unique_ptr<LinearSweeps<W>> sweeps = fast_sweeps<W>(prior.graph);
        kept = std::make_unique<NewtonLanes<W>>(prior.graph, rules_of(prior.options), std::move(sweeps));
    }
    return *kept;
}

template <class Factor>
NewtonLanes<1>& double_solver(std::unique_ptr<NewtonLanes<1>>& kept, const Quasistatic::Impl& prior,
                              const NewtonRules& rules) {
    if (!kept) {
        auto sweeps = std::make_unique<DoubleSweeps<1>>(prior.graph, std::make_unique<Factor>(prior.graph));
        kept = std::make_unique<NewtonLanes<1>>(prior.graph, rules, std::move(sweeps));
    }
    return *kept;
}

}  // namespace

void Quasistatic::project(std::span<const double> predicted, QuasistaticSolution& solution, Workspace& workspace,
                          bool warm_start) const {
    Workspace::Buffers& buffers = *workspace.buffers_;
    const size_t size = 3 * static_cast<size_t>(impl_->model.vertex_count);
    if (!warm_start) solution.position.resize(predicted.size());
    const int count = buffers.check(*impl_, predicted, solution);
    solution.report.assign(static_cast<size_t>(count), Report{});

    buffers.hard.clear();
    buffers.hard.reserve(static_cast<size_t>(count));
    std::mutex mutex;
    const auto sample = [&](int i, QuasistaticSample& out) {
        double* const position = solution.position.data() + size * static_cast<size_t>(i);
        out = {predicted.data() + size * static_cast<size_t>(i), warm_start ? position : nullptr, position,
               &solution.report[static_cast<size_t>(i)]};
    };
    const auto set_aside = [&](int i) {
        const std::lock_guard<std::mutex> lock(mutex);
        buffers.hard.push_back(i);
    };
    const bool jacobi = impl_->options.method == QuasistaticOptions::Method::newton_cg;
    sort_samples(predicted, count, workspace);
    std::atomic<int> next{0};
    const int threads = std::clamp(count, 1, buffers.threads);
    const auto work = [&](int slot) {
        const auto take = [&](QuasistaticSample& out) {
            const int k = next++;
            if (k >= count) return -1;
            const int i = buffers.order[static_cast<size_t>(k)];
            sample(i, out);
            return i;
        };
        if (jacobi)
            double_solver<BlockJacobi>(buffers.one[slot], *impl_, rules_of(impl_->options))
                .run(std::cref(take), std::cref(set_aside));
        else if (count == 1)
            fast_solver<1>(buffers.one[slot], *impl_).run(std::cref(take), std::cref(set_aside));
        else
            fast_solver<8>(buffers.eight[slot], *impl_).run(std::cref(take), std::cref(set_aside));
    };
    on_threads(threads, std::cref(work));
    if (!jacobi && !buffers.hard.empty()) project_hard(predicted, solution, workspace);
}

/// Lines the samples up so that those of a group need about as many steps: a group is as slow as its slowest.
void Quasistatic::sort_samples(std::span<const double> predicted, int count, Workspace& workspace) const {
    Workspace::Buffers& buffers = *workspace.buffers_;
    const size_t size = 3 * static_cast<size_t>(impl_->model.vertex_count);
    buffers.order.resize(static_cast<size_t>(count));
    buffers.distance.resize(static_cast<size_t>(count));
    for (size_t i = 0; i < buffers.order.size(); ++i) {
        buffers.order[i] = static_cast<int>(i);
        buffers.distance[i] = distance_from_rest(impl_->model, predicted.data() + size * i);
    }
    std::sort(buffers.order.begin(), buffers.order.end(),
              [&](int i, int j) { return std::pair(-buffers.distance[i], i) < std::pair(-buffers.distance[j], j); });
}

/// Goes on with the samples that were set aside, one at a time, with the complete factor.
void Quasistatic::project_hard(std::span<const double> predicted, QuasistaticSolution& solution,
                               Workspace& workspace) const {
    Workspace::Buffers& buffers = *workspace.buffers_;
    const size_t size = 3 * static_cast<size_t>(impl_->model.vertex_count);
    std::atomic<int> next{0};
    const int count = static_cast<int>(buffers.hard.size());
    on_threads(std::min(count, buffers.threads), [&](int slot) {
        double_solver<CompleteCholesky>(buffers.last_resort[slot], *impl_, rules_of_last_resort(impl_->options))
            .run(
                [&](QuasistaticSample& out) {
                    const int k = next++;
                    if (k >= count) return -1;
                    const auto i = static_cast<size_t>(buffers.hard[static_cast<size_t>(k)]);
                    double* const position = solution.position.data() + size * i;
                    out = {predicted.data() + size * i, position, position, &solution.report[i]};
                    return k;
                },
                [](int) {});
    });
}

QuasistaticSolution project_quasistatic(const ClothMesh& mesh, const Positions& predicted, double mu,
                                        const QuasistaticStiffness& stiffness, const QuasistaticOptions& options) {
    const Quasistatic prior(QuasistaticModel::from(rest_state(mesh), stiffness, mu), options);
    Quasistatic::Workspace workspace(prior);
    QuasistaticSolution solution;
    prior.project({predicted.data(), static_cast<size_t>(predicted.size())}, solution, workspace);
    return solution;
}

}  // namespace toile::prior
