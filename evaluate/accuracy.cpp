#include "evaluate/accuracy.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "evaluate/accuracy_results.h"
#include "evaluate/accuracy_shown.h"
#include "evaluate/noise_floor.h"
#include "evaluate/prediction_source.h"
#include "evaluate/prior_methods.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"

namespace toile::evaluate {
namespace {

/// A predictor with what is done to its predictions.
struct Judged {
    PredictionSource source;
    std::vector<PriorMethod> method;
};

/// What the steps of an evaluation share.
struct Run {
    const AccuracyOptions& options;
    const TrueSamples& samples;
    const ClothJudge& judge;
    PriorRunner& runner;
    std::vector<Judged>& judged;
    AccuracySummary& summary;

    void check_interrupt() const {
        if (options.interrupted && *options.interrupted)
            throw generate::Interrupted("interrupted: no accuracy was written");
    }
};

void check_number(double value, double low, const std::string& flag, const std::string& what) {
    if (!std::isfinite(value) || value < low) throw Error(fmt::format("{:g} is no {}", value, what), flag);
}

std::vector<int> judged_splits(const std::vector<JudgedSplit>& chosen) {
    std::vector<int> splits;
    for (const JudgedSplit& one : chosen) splits.push_back(one.split);
    return splits;
}

std::vector<PriorMethod> asked_methods(const AccuracyOptions& options, int vertices) {
    std::vector<PriorMethod> methods(1);
    for (const double limit : options.limits) methods.push_back(PriorMethod::inextensibility(limit));
    for (const double mu : options.mus) methods.push_back(PriorMethod::quasistatic(mu, vertices));
    return methods;
}

/// Learns μ for each predictor, where there is something to learn from, and adds it to the methods.
void learn_all(const AccuracyOptions& options, const files::DatasetReader& dataset, std::vector<Judged>& judged,
               AccuracySummary& summary) {
    const LearnMuOptions learn{options.learn_mu.value_or(LearnMu::vertex), options.jobs, options.progress,
                               options.interrupted};
    if (learn.what == LearnMu::none) return;
    for (Judged& one : judged) {
        const std::string& why = one.source.why_no_train;
        if (!why.empty()) {
            if (options.learn_mu) throw Error("μ cannot be learned: " + why, one.source.about, "leave out --learn-mu");
            summary.remark.push_back("μ was not learned for " + one.source.name + ": " + why);
            continue;
        }
        summary.mu.push_back(learn_mu(dataset, one.source, learn));
        const MuFit& fit = summary.mu.back().fit;
        one.method.push_back(PriorMethod::quasistatic(fit.global.mu, summary.vertices, "best"));
        if (fit.vertex.mu.size() > 0) one.method.push_back(PriorMethod::quasistatic_vertex(fit.vertex.mu));
    }
}

/// Empty columns for every sample that will be judged.
void make_columns(const std::vector<Judged>& judged, AccuracySummary& summary) {
    size_t count = 0;
    for (const JudgedSplit& one : summary.split) count += one.slot.size();
    AccuracyFigures& figures = summary.figures;
    figures.id.resize(count);
    figures.split.resize(count);
    const auto columns = [&](const std::string& name, const std::string& title, double setting) {
        return MethodFigures{name, title, setting, std::vector<QuantityValues>(count), std::vector<int8_t>(count, 0)};
    };
    figures.truth = {"target", {columns("target", "the truth", 0)}};
    for (const Judged& one : judged) {
        PredictorFigures& predictor = figures.predictor.emplace_back();
        predictor.predictor = one.source.name;
        for (const PriorMethod& method : one.method)
            predictor.method.push_back(columns(method.name, method.title, method.setting));
    }
}

Positions cloth_of(const std::vector<double>& position, size_t k, Eigen::Index vertices) {
    return Eigen::Map<const Positions>(position.data() + k * 3 * static_cast<size_t>(vertices), vertices, 3);
}

/// Notes what a prior did not solve, and what came out without a value.
void note_failures(const Run& run, const PredictorFigures& predictor, MethodFigures& method, const MethodResult& result,
                   size_t first, size_t count) {
    for (size_t k = 0; k < count; ++k) {
        const std::int64_t id = run.summary.figures.id[first + k];
        std::string what;
        if (!std::isfinite(at(method.sample[first + k], Quantity::sqrt_mse))) what = "is not finite";
        if (!result.report.empty() && result.report[k].status != prior::Status::converged) {
            method.status[first + k] = static_cast<std::int8_t>(result.report[k].status);
            what = fmt::format("did not reach the accuracy: residual {:.2e}", result.report[k].residual);
        }
        if (!what.empty()) run.summary.failure.push_back({predictor.predictor, method.method, id, what});
    }
}

void judge_methods(const Run& run, const std::vector<TrueSample>& truth, size_t predictor, size_t first) {
    const Judged& judged = run.judged[predictor];
    PredictorFigures& figures = run.summary.figures.predictor[predictor];
    std::vector<double> predicted;
    for (const TrueSample& one : truth) {
        const Positions position = judged.source.predict(one.record);
        predicted.insert(predicted.end(), position.data(), position.data() + position.size());
    }
    for (size_t m = 0; m < judged.method.size(); ++m) {
        run.check_interrupt();
        const MethodResult result = run.runner.run(judged.method[m], predicted);
        MethodFigures& method = figures.method[m];
        parallel_for(static_cast<int>(truth.size()), run.options.jobs, [&](int, int index) {
            const auto k = static_cast<size_t>(index);
            const JudgedTarget& target = truth[k].target;
            method.sample[first + k] = run.judge.judge(cloth_of(result.position, k, target.position.rows()), target);
        });
        note_failures(run, figures, method, result, first, truth.size());
    }
}

void judge_block(const Run& run, std::span<const int> slot, size_t first) {
    const std::vector<TrueSample> truth = run.samples.read(slot, run.options.jobs);
    AccuracyFigures& figures = run.summary.figures;
    for (size_t k = 0; k < truth.size(); ++k) {
        figures.id[first + k] = truth[k].record.id;
        figures.split[first + k] = truth[k].record.split;
    }
    parallel_for(static_cast<int>(truth.size()), run.options.jobs, [&](int, int index) {
        const auto k = static_cast<size_t>(index);
        figures.truth.method[0].sample[first + k] = run.judge.judge(truth[k].target.position, truth[k].target);
    });
    for (size_t predictor = 0; predictor < run.judged.size(); ++predictor) judge_methods(run, truth, predictor, first);
}

void judge_all(const Run& run) {
    const int size = run.samples.block_size(run.options.jobs);
    const int total = static_cast<int>(run.summary.figures.id.size());
    size_t first = 0;
    for (const JudgedSplit& split : run.summary.split)
        for (size_t here = 0; here < split.slot.size();) {
            run.check_interrupt();
            const auto failed = static_cast<int>(run.summary.failure.size());
            if (run.options.progress) run.options.progress({"judging", static_cast<int>(first), total, failed});
            const auto count = static_cast<size_t>(next_batch(static_cast<int>(split.slot.size() - here), size));
            judge_block(run, std::span(split.slot).subspan(here, count), first);
            here += count;
            first += count;
        }
}

Shown show(const Run& run) {
    std::vector<int> all;
    for (const JudgedSplit& split : run.summary.split) all.insert(all.end(), split.slot.begin(), split.slot.end());
    std::vector<double> error;
    for (const QuantityValues& one : run.summary.figures.predictor.front().method.front().sample)
        error.push_back(at(one, Quantity::sqrt_mse));
    std::vector<int> slot;
    for (const int k : worst_samples(run.summary.figures.split, error, run.options.shown))
        slot.push_back(all[static_cast<size_t>(k)]);
    if (run.options.progress) run.options.progress({"keeping samples to look at", 0, 0, 0});
    const Judged& first = run.judged.front();
    return make_shown(run.samples, run.judge, slot, first.source, first.method, run.runner, run.options.jobs);
}

std::string noise_path(const AccuracyOptions& options, const generate::OutputFolder& folder) {
    if (!options.noise.empty()) return options.noise;
    std::error_code ignored;
    return std::filesystem::exists(folder.file("noise.h5"), ignored) ? folder.file("noise.h5") : std::string();
}

void add_remarks(const AccuracyOptions& options, bool has_body, AccuracySummary& summary) {
    for (const JudgedSplit& one : summary.split) {
        const int failed = one.there - one.accepted;
        if (failed > 0)
            summary.remark.push_back(fmt::format("{} of the {} {} samples have no accepted drape and are not judged",
                                                 failed, one.there, split_name(one.split)));
        if (static_cast<int>(one.slot.size()) < one.accepted)
            summary.remark.push_back(fmt::format("of the {} accepted {} samples {} were drawn, by the data set's seed",
                                                 one.accepted, split_name(one.split), one.slot.size()));
        if (static_cast<int>(one.slot.size()) < fewest_samples)
            summary.remark.push_back(
                fmt::format("{} {} samples are too few to tell methods apart", one.slot.size(), split_name(one.split)));
    }
    if (!has_body) summary.remark.emplace_back("the data set has no body: nothing is said about penetration");
    if (!summary.floor)
        summary.remark.emplace_back(
            "the simulator's noise is not known here: differences are held against their intervals alone");
    summary.remark.push_back(fmt::format("edges count as overstretched beyond {:g} times their rest length",
                                         1 + options.overstretched_limit));
}

}  // namespace

void AccuracyOptions::validate() const {
    if (jobs < 1) throw Error("one job at least", "--jobs");
    if (samples < 0) throw Error("a number of samples is not negative", "--samples");
    if (shown < 0) throw Error("a number of samples is not negative", "--shown");
    for (const double limit : limits) check_number(limit, 0.0, "--limit", "limit: it is 0 or more");
    for (const double mu : mus) check_number(mu, 1e-12, "--mu", "stiffness: μ is above 0");
    check_number(overstretched_limit, 0.0, "--overstretched", "limit: it is 0 or more");
}

AccuracySummary evaluate_accuracy(const AccuracyOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    options.validate();
    const files::DatasetReader dataset(options.dataset);
    AccuracySummary summary;
    summary.split = choose_samples(dataset, options.splits, options.samples);
    summary.vertices = dataset.header().mesh.vertex_count();
    const ClothJudge judge(dataset.header().mesh, options.overstretched_limit, options.dataset);
    std::vector<Judged> judged;
    for (PredictionSource& source : prediction_sources(options.predictions, dataset, judged_splits(summary.split)))
        judged.push_back({std::move(source), asked_methods(options, summary.vertices)});
    const generate::OutputFolder folder(options.folder, generate::OutputFolder::For::results);
    if (const std::string noise = noise_path(options, folder); !noise.empty())
        summary.floor = read_noise_floor(noise, judge);

    learn_all(options, dataset, judged, summary);
    const TrueSamples samples(dataset, judge);
    PriorRunner runner(dataset.header().mesh, options.jobs, options.dataset);
    make_columns(judged, summary);
    const Run run{options, samples, judge, runner, judged, summary};
    judge_all(run);
    summary.verdicts = judge_figures(summary.figures, summary.floor, static_cast<std::uint64_t>(dataset.header().seed));
    add_remarks(options, samples.has_body(), summary);
    const Shown shown = show(run);
    summary.results = folder.file("accuracy.json");
    summary.figures_file = folder.file("accuracy.h5");
    write_accuracy(options, dataset.header(), shown, summary);
    summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return summary;
}

}  // namespace toile::evaluate
