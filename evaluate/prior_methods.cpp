#include "evaluate/prior_methods.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <utility>

namespace toile::evaluate {

struct PriorRunner::Impl {
    prior::RestState rest;
    int threads;
    prior::Inextensibility inextensibility;
    prior::Inextensibility::Workspace inextensibility_workspace;
    prior::Quasistatic quasistatic;
    prior::Quasistatic::Workspace quasistatic_workspace;

    Impl(prior::RestState state, int thread_count)
        : rest(std::move(state)),
          threads(thread_count),
          inextensibility(prior::InextensibilityModel::from(rest, 0.0)),
          inextensibility_workspace(inextensibility, threads),
          quasistatic(prior::QuasistaticModel::from(rest)),
          quasistatic_workspace(quasistatic, threads) {}
};

PriorMethod PriorMethod::inextensibility(double limit) {
    PriorMethod method;
    method.kind = Kind::inextensibility;
    method.name = fmt::format("inextensibility@limit={:g}", limit);
    method.title = fmt::format("after the inextensibility prior, limit {:g}", limit);
    method.setting = limit;
    return method;
}

PriorMethod PriorMethod::quasistatic(double mu, int vertex_count, const std::string& label) {
    PriorMethod method;
    method.kind = Kind::quasistatic;
    method.name = "quasistatic@mu=" + (label.empty() ? fmt::format("{:g}", mu) : label);
    method.title = fmt::format("after the quasistatic prior, μ = {:.3g}", mu);
    method.setting = mu;
    method.mu = Eigen::VectorXd::Constant(vertex_count, mu);
    return method;
}

PriorMethod PriorMethod::quasistatic_vertex(const Eigen::VectorXd& mu) {
    PriorMethod method;
    method.kind = Kind::quasistatic;
    method.name = "quasistatic@mu=vertex";
    method.title = "after the quasistatic prior, μ per vertex";
    method.setting = std::exp(mu.array().log().mean());
    method.mu = mu;
    return method;
}

PriorRunner::PriorRunner(const ClothMesh& mesh, int threads, const std::string& where)
    : impl_(std::make_unique<Impl>(prior::rest_state(mesh, where), threads)) {}
PriorRunner::~PriorRunner() = default;

MethodResult PriorRunner::run(const PriorMethod& method, std::span<const double> predicted) {
    MethodResult result;
    if (method.kind == PriorMethod::Kind::inextensibility) {
        impl_->inextensibility.set_edge_max_length((1.0 + method.setting) * impl_->rest.edge_rest_length);
        prior::InextensibilitySolution solution;
        impl_->inextensibility.project(predicted, solution, impl_->inextensibility_workspace);
        result = {std::move(solution.position), std::move(solution.report)};
    } else if (method.kind == PriorMethod::Kind::quasistatic) {
        impl_->quasistatic.set_mu(method.mu);
        prior::QuasistaticSolution solution;
        impl_->quasistatic.project(predicted, solution, impl_->quasistatic_workspace);
        result = {std::move(solution.position), std::move(solution.report)};
    } else {
        result.position.assign(predicted.begin(), predicted.end());
    }
    return result;
}

int next_batch(int left, int size) {
    return left <= size + 1 ? left : size;
}

}  // namespace toile::evaluate
