#include "generate/prior_work.h"

#include <algorithm>
#include <limits>

namespace toile::generate {
namespace {

/// Row i of an array of n equal rows becomes NaN.
void make_nan(std::vector<double>& value, size_t i, size_t n) {
    const size_t width = value.size() / n;
    std::fill_n(value.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                std::numeric_limits<double>::quiet_NaN());
}

class InextensibilityWork : public PriorWork {
  public:
    InextensibilityWork(const ProjectConfig& config, const prior::RestState& rest, int threads)
        : prior_(prior::InextensibilityModel::from(rest, config.stretch_limit), config.inextensibility),
          workspace_(prior_, threads) {}

    void describe(files::ProjectionHeader& header) const override {
        const prior::InextensibilityModel& model = prior_.model();
        header.limits = {model.edge, model.edge_max_length};
        header.target_stiffness = model.target_stiffness;
    }
    void project(std::span<const double> predicted) override { prior_.project(predicted, solution_, workspace_); }
    void differentiate(std::span<const double>, std::span<const double> loss_gradient) override {
        prior_.backward(solution_, loss_gradient, gradient_, workspace_);
    }
    void void_gradient(size_t i) override { make_nan(gradient_.predicted, i, solution_.report.size()); }

    const std::vector<double>& position() const override { return solution_.position; }
    const std::vector<prior::Report>& report() const override { return solution_.report; }
    const std::vector<prior::DerivativeReport>& derivative_report() const override { return gradient_.report; }
    void fill(files::ProjectionRows& rows, bool gradient) const override {
        rows.projected = solution_.position;
        rows.multiplier = solution_.multiplier;
        if (!gradient) return;
        rows.gradient = gradient_.predicted;
        rows.weakly_active.clear();
        rows.active_set_distance.clear();
        for (const prior::DerivativeReport& one : gradient_.report) {
            rows.weakly_active.push_back(one.weakly_active);
            rows.active_set_distance.push_back(one.active_set_distance);
        }
    }

  private:
    prior::Inextensibility prior_;
    prior::Inextensibility::Workspace workspace_;
    prior::InextensibilitySolution solution_;
    prior::InextensibilityGradient gradient_;
};

class QuasistaticWork : public PriorWork {
  public:
    QuasistaticWork(const ProjectConfig& config, const prior::RestState& rest, int threads)
        : prior_(prior::QuasistaticModel::from(rest, config.stiffness, config.mu), config.quasistatic),
          workspace_(prior_, threads) {}

    void describe(files::ProjectionHeader& header) const override {
        const prior::QuasistaticModel& model = prior_.model();
        header.springs = {model.edge_spring,    model.edge_stiffness,    model.edge_rest_length,
                          model.bending_spring, model.bending_stiffness, model.bending_rest_length,
                          model.axial_spring,   model.axial_weight,      model.axial_stiffness};
        header.target_stiffness = model.target_stiffness;
    }
    void project(std::span<const double> predicted) override { prior_.project(predicted, solution_, workspace_); }
    void differentiate(std::span<const double> predicted, std::span<const double> loss_gradient) override {
        prior_.backward(predicted, solution_, loss_gradient, gradient_, workspace_);
    }
    void void_gradient(size_t i) override {
        const size_t n = solution_.report.size();
        for (auto* value : {&gradient_.predicted, &gradient_.mu, &gradient_.mu_vertex}) make_nan(*value, i, n);
    }

    const std::vector<double>& position() const override { return solution_.position; }
    const std::vector<prior::Report>& report() const override { return solution_.report; }
    const std::vector<prior::DerivativeReport>& derivative_report() const override { return gradient_.report; }
    void fill(files::ProjectionRows& rows, bool gradient) const override {
        rows.projected = solution_.position;
        if (!gradient) return;
        rows.gradient = gradient_.predicted;
        rows.gradient_mu = gradient_.mu;
        rows.gradient_mu_vertex = gradient_.mu_vertex;
    }

  private:
    prior::Quasistatic prior_;
    prior::Quasistatic::Workspace workspace_;
    prior::QuasistaticSolution solution_;
    prior::QuasistaticGradient gradient_;
};

}  // namespace

std::unique_ptr<PriorWork> make_prior_work(const ProjectConfig& config, const prior::RestState& rest, int threads) {
    if (config.prior == Prior::inextensibility) return std::make_unique<InextensibilityWork>(config, rest, threads);
    return std::make_unique<QuasistaticWork>(config, rest, threads);
}

}  // namespace toile::generate
