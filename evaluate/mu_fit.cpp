#include "evaluate/mu_fit.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "cloth/error.h"
#include "evaluate/mu_global.h"
#include "evaluate/mu_loss.h"
#include "evaluate/mu_smoothing.h"
#include "evaluate/mu_vertex.h"
#include "evaluate/noise_source.h"
#include "generate/ordered_work.h"

namespace toile::evaluate {
namespace {

constexpr int scan_samples = 12;   // enough to find the decade
constexpr int held_out_every = 4;  // train samples, where there is no validation split

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void require(bool holds, const std::string& what) {
    if (!holds) throw Error(what);
}

ClothPairs read_some(const MuSamples& samples, int most, size_t size, std::uint64_t seed) {
    ClothPairs pairs;
    if (samples.count < 1) return pairs;
    const double share = static_cast<double>(std::min(most, samples.count)) / samples.count;
    for (const int index : drawn_share(samples.count, share, seed)) {
        pairs.predicted.resize(pairs.predicted.size() + size);
        pairs.target.resize(pairs.target.size() + size);
        const std::span<double> predicted(pairs.predicted.end() - static_cast<std::ptrdiff_t>(size), size);
        const std::span<double> target(pairs.target.end() - static_cast<std::ptrdiff_t>(size), size);
        samples.read(index, predicted, target);
        for (const std::span<double>& one : {predicted, target})
            require(std::all_of(one.begin(), one.end(), [](double x) { return std::isfinite(x); }),
                    "sample " + std::to_string(index) + " for learning mu has positions that are not finite");
    }
    return pairs;
}

/// Moves every fourth sample from `train` to `other`.
void hold_out(ClothPairs& train, ClothPairs& other, size_t size) {
    ClothPairs kept;
    for (size_t first = 0, i = 0; first < train.predicted.size(); first += size, ++i) {
        ClothPairs& to = i % held_out_every == held_out_every - 1 ? other : kept;
        const auto copy = [&](const std::vector<double>& from, std::vector<double>& into) {
            const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
            into.insert(into.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
        };
        copy(train.predicted, to.predicted);
        copy(train.target, to.target);
    }
    train = std::move(kept);
}

MuErrors errors_of(MuLoss& loss, const Eigen::VectorXd& mu, double reference) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (loss.sample_count() == 0) return {nan, nan, nan};
    const auto error = [&](const Eigen::VectorXd& x) { return std::sqrt(loss(x, false).squared_error); };
    return {std::sqrt(loss.predicted_squared_error()),
            error(Eigen::VectorXd::Constant(loss.vertex_count(), std::log(reference))),
            error(mu.array().log().matrix())};
}

std::string meaning(MuStatus status, double low, double high) {
    switch (status) {
        case MuStatus::converged:
            return "the loss has a minimum there";
        case MuStatus::iterations_used:
            return "the loss still fell when the iterations were used up";
        case MuStatus::at_lower_bound:
            return fmt::format("the bound {:g}: the prior alone does better than when it keeps to the predictions",
                               low);
        case MuStatus::at_upper_bound:
            return fmt::format(
                "the bound {:g}: on the train split the predictions are better than what the prior makes "
                "of them",
                high);
        case MuStatus::no_derivative:
            return "the best of a scan: no projection had a derivative";
    }
    return {};
}

std::string sentence_of(const MuFit& fit, const MuFitOptions& options) {
    const MuGlobalFit& global = fit.global;
    std::string text = fmt::format(
        "Learned on {} of {} train samples: mu = {:.4g} ({}), train error {:.3f} mm against {:.3f} mm at mu = {:g} and "
        "{:.3f} mm of the predictions.",
        fit.samples, fit.samples_offered, global.mu, meaning(global.status, options.low, options.high),
        1e3 * global.train.fitted, 1e3 * global.train.reference, options.reference, 1e3 * global.train.predicted);
    if (fit.vertex.mu.size() > 0 && std::isfinite(fit.vertex.smoothness))
        text += fmt::format(
            " Per vertex, from {:.3g} to {:.3g} with the smoothness weight {:g} ({}): train error {:.3f} mm.",
            fit.vertex.mu.minCoeff(), fit.vertex.mu.maxCoeff(), fit.vertex.smoothness,
            meaning(fit.vertex.status, options.low, options.high), 1e3 * fit.vertex.train.fitted);
    else if (fit.vertex.mu.size() > 0)
        text += " Per vertex, no weight of the smoothness term did better on the samples held out than the global mu.";
    if (fit.left_out > 0)
        text += fmt::format(" Up to {} samples had no derivative and were left out of it.", fit.left_out);
    return text;
}

}  // namespace

void MuFitOptions::validate() const {
    const auto finite = [](double x) { return std::isfinite(x); };
    require(finite(low) && low > 0.0, fmt::format("the lower bound of mu is {:g}; it must be above 0", low));
    require(finite(high) && high >= 1.1 * low,
            fmt::format("the upper bound of mu is {:g}; it must be at least 1.1 times the lower one, {:g}", high, low));
    require(reference >= low && reference <= high,
            fmt::format("the reference mu is {:g}; it must be from {:g} to {:g}", reference, low, high));
    require(samples >= 1, fmt::format("samples to learn mu from: {}; it must be at least 1", samples));
    require(validation_samples >= 0,
            fmt::format("validation samples to learn mu with: {}; it must be 0 or more", validation_samples));
    require(!per_vertex || !smoothness.empty(), "mu per vertex needs a weight of the smoothness term");
    for (const double weight : smoothness)
        require(finite(weight) && weight > 0.0,
                fmt::format("a weight of the smoothness term of mu is {:g}; it must be above 0", weight));
    require(iterations >= 1, fmt::format("iterations to learn mu: {}; it must be at least 1", iterations));
    require(jobs >= 1, fmt::format("threads to learn mu: {}; it must be at least 1", jobs));
}

std::string mu_status_name(MuStatus status) {
    switch (status) {
        case MuStatus::converged:
            return "converged";
        case MuStatus::iterations_used:
            return "iterations_used";
        case MuStatus::at_lower_bound:
            return "at_lower_bound";
        case MuStatus::at_upper_bound:
            return "at_upper_bound";
        case MuStatus::no_derivative:
            return "no_derivative";
    }
    return {};
}

MuFit fit_mu(const ClothMesh& mesh, const MuSamples& train, const MuSamples& validation, const MuFitOptions& options) {
    options.validate();
    require(train.count >= 1, "there is no train sample to learn mu from");
    const auto start = std::chrono::steady_clock::now();
    const prior::QuasistaticModel model = prior::QuasistaticModel::from(prior::rest_state(mesh), options.stiffness);
    const size_t size = 3 * static_cast<size_t>(model.vertex_count);
    ClothPairs pairs = read_some(train, options.samples, size, options.seed);
    ClothPairs other = read_some(validation, options.validation_samples, size, options.seed);
    if (other.predicted.empty()) hold_out(pairs, other, size);
    const auto loss_of = [&](ClothPairs some) {
        return MuLoss(model, options.tolerance, std::move(some), options.jobs);
    };
    MuLoss loss = loss_of(std::move(pairs)), held_out = loss_of(std::move(other));
    MuLoss scan = loss_of(loss.some(scan_samples));

    MuFit fit;
    fit.samples = loss.sample_count();
    fit.validation_samples = held_out.sample_count();
    fit.samples_offered = train.count;
    const Eigen::VectorXd reference = Eigen::VectorXd::Constant(loss.vertex_count(), std::log(options.reference));
    const double reference_error = loss(reference, false).squared_error;
    const double unit = reference_error > 0.0 ? reference_error : 1.0;
    int evaluations = 0;
    const auto evaluated = [&](const std::string& stage) {
        if (options.interrupted && *options.interrupted) throw generate::Interrupted("interrupted while learning mu");
        if (options.progress) options.progress(stage, evaluations, 0);
        ++evaluations;
    };

    fit.global = fit_global_mu(
        loss, scan, options, unit, [&] { evaluated("learning mu"); }, fit.left_out);
    const Eigen::VectorXd global = Eigen::VectorXd::Constant(loss.vertex_count(), fit.global.mu);
    fit.global.train = errors_of(loss, global, options.reference);
    fit.global.validation = errors_of(held_out, global, options.reference);
    fit.global.seconds = seconds_since(start);
    if (options.per_vertex) {
        const auto vertex_start = std::chrono::steady_clock::now();
        const MuSmoothing smoothing(mesh.triangle, loss.vertex_count());
        fit.vertex = fit_vertex_mu(
            loss, held_out, smoothing, options, fit.global.mu, unit, [&] { evaluated("learning mu per vertex"); },
            fit.left_out);
        fit.vertex.train = errors_of(loss, fit.vertex.mu, options.reference);
        fit.vertex.validation = errors_of(held_out, fit.vertex.mu, options.reference);
        fit.vertex.seconds = seconds_since(vertex_start);
    }
    fit.sentence = sentence_of(fit, options);
    return fit;
}

}  // namespace toile::evaluate
