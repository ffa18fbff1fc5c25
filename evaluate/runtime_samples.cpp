#include "evaluate/runtime_samples.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cloth/error.h"
#include "evaluate/noise_source.h"
#include "evaluate/stress_predictions.h"
#include "files/predictions_file.h"

namespace toile::evaluate {
namespace {

constexpr int read_at_once = 64;

/// Slots of the accepted samples, in order of the file.
std::vector<int> accepted_slots(const files::DatasetReader& dataset) {
    std::vector<int> slot;
    for (int first = 0; first < dataset.sample_count(); first += read_at_once) {
        const int here = std::min(read_at_once, dataset.sample_count() - first);
        const std::vector<files::SampleRecord> record = dataset.read_columns(first, here);
        for (int k = 0; k < here; ++k)
            if (record[k].status == 0) slot.push_back(first + k);
    }
    return slot;
}

std::string short_millimetres(double metres) {
    return fmt::format("{:.3g}", 1e3 * metres);
}

std::vector<double> flat(const Positions& position) {
    return {position.data(), position.data() + position.size()};
}

}  // namespace

Positions noisy_cloth(const Positions& cloth, const Positions& rest, double rms, double roughness, std::uint64_t seed) {
    Random random(seed);
    const Positions smooth = smooth_field(rest, random);
    const Positions white = white_field(static_cast<int>(cloth.rows()), random);
    return cloth + rms * (std::sqrt(8.0) / 3.0 * smooth + roughness / 3.0 * white);
}

namespace {

/// Of slots of the file, those that have a prediction.
std::vector<int> predicted_slots(const files::DatasetReader& dataset, const std::vector<int>& slot,
                                 const files::PredictionsReader& predictions) {
    if (predictions.vertex_count() != dataset.header().mesh.vertex_count())
        throw Error("the predictions have " + std::to_string(predictions.vertex_count()) + " vertices, the data set " +
                        std::to_string(dataset.header().mesh.vertex_count()),
                    predictions.path() + ":/samples/predicted", "predict this data set: toile predict");
    std::vector<int> left;
    for (const int one : slot)
        if (predictions.has(dataset.read_columns(one, 1)[0].id)) left.push_back(one);
    if (left.empty())
        throw Error("the predictions are of none of the data set's accepted samples",
                    predictions.path() + ":/samples/id", "predict this data set: toile predict");
    return left;
}

void add_noise(RuntimeSamples& samples, const RuntimePredictions& predictions) {
    samples.predictions =
        "the truth with seeded noise of " + short_millimetres(predictions.noise) + " mm root mean square";
    for (const files::SampleRecord& record : samples.record)
        samples.predicted.push_back(flat(noisy_cloth(record.cloth, samples.header.mesh.rest_position, predictions.noise,
                                                     1.0, predictions.seed * 1000003u + std::uint64_t(record.id))));
}

void add_predicted(RuntimeSamples& samples, const files::PredictionsReader& predictions) {
    samples.predictions = predictions.predictor() + " (" + predictions.path() + ")";
    for (const files::SampleRecord& record : samples.record) {
        const Positions predicted = predictions.read(record.id);
        if (!predicted.allFinite())
            throw Error("the prediction of sample " + std::to_string(record.id) + " is not finite",
                        predictions.path() + ":/samples/predicted");
        samples.predicted.push_back(flat(predicted));
    }
}

}  // namespace

RuntimeSamples read_runtime_samples(const std::string& dataset, int count, const RuntimePredictions& predictions) {
    const files::DatasetReader reader(dataset);
    std::optional<files::PredictionsReader> predicted;
    if (!predictions.file.empty()) predicted.emplace(predictions.file);
    std::vector<int> slot = accepted_slots(reader);
    if (slot.empty()) throw Error("the data set has no accepted sample to measure on", dataset);
    if (predicted) slot = predicted_slots(reader, slot, *predicted);
    RuntimeSamples samples;
    samples.header = reader.header();
    samples.rest = prior::rest_state(samples.header.mesh, dataset);
    samples.accepted = static_cast<int>(slot.size());
    const double share = std::min(1.0, static_cast<double>(count) / static_cast<double>(slot.size()));
    for (const int index : drawn_share(samples.accepted, share, predictions.seed))
        samples.record.push_back(reader.read(slot[index]));
    std::sort(samples.record.begin(), samples.record.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    for (const files::SampleRecord& record : samples.record) samples.target.push_back(flat(record.cloth));
    if (predicted)
        add_predicted(samples, *predicted);
    else
        add_noise(samples, predictions);
    return samples;
}

}  // namespace toile::evaluate
