#pragma once

#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "bench/speed_scene.h"
#include "prior/report.h"

namespace toile::bench {

/// One prior on one scene, made ready to be timed: `project_*` and `backward_*` are what is timed, `defect` tells
/// whether the results are worth timing. `Traits` names the prior's types and the few calls that differ between the
/// two.
template <typename Traits>
class TimedPrior {
  public:
    /// Projects the first `samples` of the scene as a batch, and `alone` of them, evenly spread, one by one.
    TimedPrior(const SpeedScene& scene, int samples, int alone, const typename Traits::Options& options)
        : scene_(scene),
          samples_(samples),
          each_(scene.predicted.size() / scene.samples),
          prior_(Traits::model(scene.rest), options),
          workspace_(prior_) {
        prior_.project(predicted(0, samples), solution_, workspace_);
        start_ = solution_;
        alone_.resize(alone);
        for (int k = 0; k < alone; ++k) project_alone(k);
    }

    int samples() const { return samples_; }
    int alone() const { return static_cast<int>(alone_.size()); }
    void project_batch() { prior_.project(predicted(0, samples_), solution_, workspace_); }
    void project_alone(int k) { prior_.project(predicted(sample_alone(k), 1), alone_[k], workspace_); }
    /// Not timed: puts the earlier solution back, from which `project_warm` starts.
    void forget() { warm_ = start_; }
    void project_warm() { prior_.project(part(scene_.moved, 0, samples_), warm_, workspace_, true); }
    void backward_batch() {
        Traits::backward(prior_, predicted(0, samples_), start_, part(scene_.loss_gradient, 0, samples_), gradient_,
                         workspace_);
    }
    void backward_alone(int k) {
        Traits::backward(prior_, predicted(sample_alone(k), 1), alone_[k],
                         part(scene_.loss_gradient, sample_alone(k), 1), gradient_, workspace_);
    }

    double mean_iterations() const { return mean_iterations(solution_.report); }
    double mean_iterations_warm() const { return mean_iterations(warm_.report); }
    double mean_iterations_alone() const {
        double sum = 0;
        for (const auto& solution : alone_) sum += mean_iterations(solution.report);
        return sum / alone();
    }

    /// Empty if every sample, in the batch and alone, is converged, and its residual, computed again, within the
    /// tolerance.
    std::string forward_defect() const {
        for (int s = 0; s < samples_; ++s)
            if (!good(predicted(s, 1), solution_, s)) return shortfall(s, solution_.report[s]);
        for (int k = 0; k < alone(); ++k)
            if (!good(predicted(sample_alone(k), 1), alone_[k], 0))
                return shortfall(sample_alone(k), alone_[k].report[0]);
        return {};
    }
    /// The same of a warm start's results.
    std::string warm_defect() const {
        for (int s = 0; s < samples_; ++s)
            if (!good(part(scene_.moved, s, 1), warm_, s)) return shortfall(s, warm_.report[s]);
        return {};
    }
    /// Empty if every derivative of the last `backward` reached its accuracy.
    std::string backward_defect() const {
        std::ostringstream text;
        for (const prior::DerivativeReport& report : gradient_.report)
            if (report.status != prior::Status::converged && text.str().empty())
                text << "a derivative is not accurate: linear residual " << report.linear_residual;
        return text.str();
    }

  private:
    std::span<const double> part(const std::vector<double>& all, int first, int count) const {
        return std::span<const double>(all).subspan(first * each_, count * each_);
    }
    std::span<const double> predicted(int first, int count) const { return part(scene_.predicted, first, count); }
    int sample_alone(int k) const { return k * samples_ / alone(); }
    bool good(std::span<const double> predicted, const typename Traits::Solution& solution, int sample) const {
        return solution.report[sample].status == prior::Status::converged &&
               Traits::residual(prior_, predicted, solution, sample) <= prior_.options().tolerance;
    }
    static std::string shortfall(int sample, const prior::Report& report) {
        std::ostringstream text;
        text << "sample " << sample << " did not reach its tolerance: residual " << report.residual;
        return text.str();
    }
    static double mean_iterations(const std::vector<prior::Report>& report) {
        double sum = 0;
        for (const prior::Report& each : report) sum += each.iterations;
        return sum / static_cast<double>(report.size());
    }

    const SpeedScene& scene_;
    int samples_;
    std::size_t each_;
    typename Traits::Prior prior_;
    typename Traits::Prior::Workspace workspace_;
    typename Traits::Solution solution_, start_, warm_;
    std::vector<typename Traits::Solution> alone_;
    typename Traits::Gradient gradient_;
};

}  // namespace toile::bench
