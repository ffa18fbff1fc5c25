#include "evaluate/studied_prior.h"

#include <algorithm>
#include <cmath>

namespace toile::evaluate {
namespace {

using Solved = StudiedPrior::Solved;

class StudiedInextensibility final : public StudiedPrior {
  public:
    StudiedInextensibility(const prior::RestState& rest, const prior::InextensibilityOptions& options, int threads)
        : prior_(prior::InextensibilityModel::from(rest, 0.0), options), workspace_(prior_, threads) {}

    void project(std::span<const double> predicted, Solved& solved) override { run(predicted, solved, false); }
    void polish(std::span<const double> predicted, Solved& solved) override { run(predicted, solved, true); }
    void backward(std::span<const double>, const Solved& solved, std::span<const double> loss_gradient,
                  Gradient& gradient) override {
        const prior::InextensibilitySolution solution{solved.position, solved.multiplier, solved.report};
        prior_.backward(solution, loss_gradient, gradient_, workspace_);
        gradient = {gradient_.predicted, gradient_.report};
    }
    double residual(std::span<const double> predicted, const Solved& solved) const override {
        return prior::inextensibility_residual(prior_.model(), predicted, solved.position, solved.multiplier);
    }

  private:
    void run(std::span<const double> predicted, Solved& solved, bool warm) {
        prior::InextensibilitySolution solution;
        std::swap(solution.position, solved.position);
        std::swap(solution.multiplier, solved.multiplier);
        std::swap(solution.report, solved.report);
        prior_.project(predicted, solution, workspace_, warm);
        solved = {std::move(solution.position), std::move(solution.multiplier), std::move(solution.report)};
    }

    prior::Inextensibility prior_;
    prior::Inextensibility::Workspace workspace_;
    prior::InextensibilityGradient gradient_;
};

class StudiedQuasistatic final : public StudiedPrior {
  public:
    StudiedQuasistatic(const prior::RestState& rest, const prior::QuasistaticOptions& options, int threads)
        : prior_(prior::QuasistaticModel::from(rest), options), workspace_(prior_, threads) {}

    void project(std::span<const double> predicted, Solved& solved) override { run(predicted, solved, false); }
    void polish(std::span<const double> predicted, Solved& solved) override { run(predicted, solved, true); }
    void backward(std::span<const double> predicted, const Solved& solved, std::span<const double> loss_gradient,
                  Gradient& gradient) override {
        const prior::QuasistaticSolution solution{solved.position, solved.report};
        prior_.backward(predicted, solution, loss_gradient, gradient_, workspace_);
        gradient = {gradient_.predicted, gradient_.report};
    }
    double residual(std::span<const double> predicted, const Solved& solved) const override {
        return prior::quasistatic_residual(prior_.model(), predicted, solved.position);
    }

  private:
    void run(std::span<const double> predicted, Solved& solved, bool warm) {
        prior::QuasistaticSolution solution;
        std::swap(solution.position, solved.position);
        std::swap(solution.report, solved.report);
        prior_.project(predicted, solution, workspace_, warm);
        solved = {std::move(solution.position), {}, std::move(solution.report)};
    }

    prior::Quasistatic prior_;
    prior::Quasistatic::Workspace workspace_;
    prior::QuasistaticGradient gradient_;
};

SolutionMethod inextensibility(const std::string& name, prior::InextensibilityOptions::Method method) {
    return {"inextensibility", name, true, [method](const prior::RestState& rest, double tolerance, int threads) {
                prior::InextensibilityOptions options;
                options.method = method;
                options.tolerance = tolerance;
                return std::make_unique<StudiedInextensibility>(rest, options, threads);
            }};
}

SolutionMethod quasistatic(const std::string& name, prior::QuasistaticOptions::Method method) {
    return {"quasistatic", name, false, [method](const prior::RestState& rest, double tolerance, int threads) {
                prior::QuasistaticOptions options;
                options.method = method;
                options.tolerance = tolerance;
                return std::make_unique<StudiedQuasistatic>(rest, options, threads);
            }};
}

}  // namespace

std::vector<SolutionMethod> solution_methods() {
    return {inextensibility("interior_point", prior::InextensibilityOptions::Method::interior_point),
            inextensibility("cone", prior::InextensibilityOptions::Method::cone),
            quasistatic("fast", prior::QuasistaticOptions::Method::fast),
            quasistatic("newton_cg", prior::QuasistaticOptions::Method::newton_cg)};
}

std::vector<Reference> certified_references(const std::vector<SolutionMethod>& methods, const prior::RestState& rest,
                                            const std::vector<std::vector<double>>& predicted) {
    std::vector<Reference> reference(predicted.size());
    for (const SolutionMethod& method : methods) {
        const auto done = [](const Reference& one) { return one.certified; };
        if (std::all_of(reference.begin(), reference.end(), done)) break;
        const std::unique_ptr<StudiedPrior> prior = method.make(rest, reference_tolerance, 1);
        for (size_t s = 0; s < predicted.size(); ++s) {
            if (reference[s].certified) continue;
            Reference trial;
            trial.method = method.method;
            prior->project(predicted[s], trial.solved);
            trial.residual = prior->residual(predicted[s], trial.solved);
            trial.certified =
                trial.solved.report[0].status == prior::Status::converged && trial.residual <= reference_tolerance;
            if (trial.certified || reference[s].method.empty()) reference[s] = std::move(trial);
        }
    }
    return reference;
}

MinimumCheck::MinimumCheck(const SolutionMethod& method, const prior::RestState& rest)
    : needed_(!method.one_solution), least_distance_(1e-3 * rest.edge_rest_length.mean()) {
    if (needed_) prior_ = method.make(rest, reference_tolerance, 1);
}

bool MinimumCheck::other_minimum(std::span<const double> predicted, const StudiedPrior::Solved& solved,
                                 const Reference& reference) {
    if (!needed_ || solved.report[0].status == prior::Status::rejected_input) return false;
    StudiedPrior::Solved further = solved;
    prior_->polish(predicted, further);
    return cloth_distance(further.position, reference.solved.position).largest > least_distance_;
}

ClothDistance cloth_distance(std::span<const double> a, std::span<const double> b) {
    ClothDistance distance;
    double sum = 0.0;
    for (size_t k = 0; k < a.size(); k += 3) {
        const double x = a[k] - b[k], y = a[k + 1] - b[k + 1], z = a[k + 2] - b[k + 2];
        const double squared = x * x + y * y + z * z;
        sum += squared;
        distance.largest = std::max(distance.largest, std::sqrt(squared));
    }
    distance.rms = a.empty() ? 0.0 : std::sqrt(3.0 * sum / static_cast<double>(a.size()));
    return distance;
}

}  // namespace toile::evaluate
