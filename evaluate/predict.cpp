#include "evaluate/predict.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "files/predictions_file.h"
#include "files/split.h"
#include "generate/ordered_work.h"

namespace toile::evaluate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t batch_samples = 32;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Consecutive accepted samples that are in memory together.
struct Batch {
    std::vector<std::int64_t> id;
    std::vector<int> split;
    std::vector<PredictorInput> input;
    std::vector<pattern::EmbeddedCloth> embedded;
    std::vector<Positions> cloth, predicted;
};

Batch read_batch(const PredictorData& data, size_t first, bool with_image) {
    Batch batch;
    const std::vector<int>& slots = data.accepted();
    for (size_t i = first; i < std::min(first + batch_samples, slots.size()); ++i) {
        batch.id.push_back(data.id(slots[i]));
        batch.split.push_back(data.split(slots[i]));
        batch.input.push_back(data.input(slots[i], with_image));
        batch.embedded.push_back(data.embedded(slots[i]));
        batch.cloth.push_back(data.cloth(slots[i]));
    }
    return batch;
}

/// r̂ as it is stored, and judged: rounded to float32.
void predict_batch(const Predictor& predictor, Batch& batch, int jobs) {
    const std::vector<Positions> displacement = predictor.displacements(batch.input, jobs);
    batch.predicted.resize(batch.input.size());
    parallel_for(static_cast<int>(batch.input.size()), jobs, [&](int, int i) {
        const auto at = static_cast<size_t>(i);
        batch.predicted[at] = pattern::displaced(batch.embedded[at], displacement[at]).cast<float>().cast<double>();
    });
}

void write_batch(const Batch& batch, files::PredictionsWriter& writer) {
    std::vector<float> value;
    for (const Positions& one : batch.predicted) value.insert(value.end(), one.data(), one.data() + one.size());
    writer.write(batch.id, value);
}

/// Adds up squares and largest distances; `finish` makes means of them.
void count_errors(const Batch& batch, std::array<SplitError, 3>& error) {
    for (size_t i = 0; i < batch.id.size(); ++i) {
        const Eigen::VectorXd squared = (batch.predicted[i] - batch.cloth[i]).rowwise().squaredNorm();
        SplitError& split = error[static_cast<size_t>(batch.split[i])];
        ++split.samples;
        split.sqrt_mse += squared.mean();
        split.max_dist += std::sqrt(squared.maxCoeff());
    }
}

void finish(SplitError& error) {
    if (error.samples == 0) return;
    error.sqrt_mse = std::sqrt(error.sqrt_mse / static_cast<double>(error.samples));
    error.max_dist /= static_cast<double>(error.samples);
}

/// What made the predictions, as TOML: what was asked for, and what came of the fit.
std::string options_text(const PredictorOptions& options, const Predictor& predictor) {
    std::string text = fmt::format("[predict]\npredictor = \"{}\"\n", options.predictor);
    if (options.predictor == "ridge") {
        text +=
            fmt::format("components = {}\nexplained_variance = {:#}\n", options.components, options.explained_variance);
        if (options.ridge) text += fmt::format("ridge = {:#}\n", *options.ridge);
        text += fmt::format("seed = {}\n", options.seed);
    }
    text += "\n[fit]\n";
    for (const FitFact& fact : predictor.facts()) text += fmt::format("{} = {:#}\n", fact.name, fact.value);
    return text;
}

files::PredictionsHeader header_of(const PredictOptions& options, const PredictorData& data,
                                   const Predictor& predictor) {
    files::PredictionsHeader header;
    header.predictor = predictor.name();
    header.options = options_text(options.predictor, predictor);
    header.dataset_config_hash = data.dataset().header().config_hash;
    header.program_version = TOILE_VERSION;
    return header;
}

void check_out(const PredictOptions& options) {
    std::error_code absent;
    if (std::filesystem::equivalent(options.dataset, options.out, absent))
        throw Error("the predictions would replace the data set they are made from", options.out,
                    "choose another --out");
}

}  // namespace

PredictSummary predict(const PredictOptions& options) {
    const auto start = Clock::now();
    options.predictor.validate();
    const files::DatasetReader dataset(options.dataset);
    check_out(options);
    const PredictorData data(dataset);
    const auto report = [&](const char* stage, size_t done) {
        if (options.progress)
            options.progress({stage, static_cast<int>(done), static_cast<int>(data.accepted().size())});
    };
    report("fitting", 0);
    const std::unique_ptr<Predictor> predictor = fit_predictor(options.predictor, data);
    PredictSummary summary;
    summary.predictor = predictor->name();
    summary.vertices = data.vertex_count();
    summary.facts = predictor->facts();
    summary.fit_seconds = seconds_since(start);
    files::PredictionsWriter writer(options.out, header_of(options, data, *predictor),
                                    static_cast<std::int64_t>(data.accepted().size()), data.vertex_count());
    for (size_t first = 0; first < data.accepted().size(); first += batch_samples) {
        if (options.interrupted && *options.interrupted)
            throw generate::Interrupted("interrupted: no predictions were written");
        Batch batch = read_batch(data, first, predictor->needs_image());
        predict_batch(*predictor, batch, options.predictor.jobs);
        write_batch(batch, writer);
        count_errors(batch, summary.error);
        report("predicting", first + batch.id.size());
    }
    writer.finish();
    for (SplitError& one : summary.error) finish(one);
    summary.seconds = seconds_since(start);
    return summary;
}

std::string predict_table(const PredictSummary& summary) {
    std::string text = fmt::format("{} on {} vertices:", summary.predictor, summary.vertices);
    for (const FitFact& fact : summary.facts) text += fmt::format(" {} {:.5g}", fact.name, fact.value);
    text += fmt::format("\nfitted in {:.1f} s, all in {:.1f} s\n{:12}{:>8}{:>15}{:>15}\n", summary.fit_seconds,
                        summary.seconds, "split", "samples", "SqrtMSE [mm]", "MaxDist [mm]");
    for (size_t split = 0; split < summary.error.size(); ++split) {
        const SplitError& error = summary.error[split];
        if (error.samples > 0)
            text += fmt::format("{:12}{:>8}{:>15.3f}{:>15.3f}\n", files::split_name[split], error.samples,
                                1e3 * error.sqrt_mse, 1e3 * error.max_dist);
    }
    return text;
}

}  // namespace toile::evaluate
