#include "evaluate/accuracy_mu.h"

#include <algorithm>
#include <utility>

#include "files/predictions_file.h"

namespace toile::evaluate {
namespace {

MuSamples samples_of(const files::DatasetReader& dataset, const PredictionSource& source, int split) {
    const auto splits = dataset.file().read<int>("/samples/split", {dataset.sample_count()}).value;
    const auto status = dataset.file().read<int>("/samples/status", {dataset.sample_count()}).value;
    std::vector<int> slot;
    for (int k = 0; k < dataset.sample_count(); ++k)
        if (splits[static_cast<size_t>(k)] == split && status[static_cast<size_t>(k)] == 0) slot.push_back(k);
    MuSamples samples;
    samples.count = static_cast<int>(slot.size());
    samples.read = [&dataset, &source, slot = std::move(slot)](int index, std::span<double> predicted,
                                                               std::span<double> target) {
        const files::SampleRecord record = dataset.read(slot[static_cast<size_t>(index)]);
        const Positions position = source.predict(record);
        std::copy_n(position.data(), position.size(), predicted.begin());
        std::copy_n(record.cloth.data(), record.cloth.size(), target.begin());
    };
    return samples;
}

}  // namespace

LearnedMu learn_mu(const files::DatasetReader& dataset, const PredictionSource& source, const LearnMuOptions& options) {
    MuFitOptions fit;
    fit.per_vertex = options.what == LearnMu::vertex;
    fit.seed = static_cast<std::uint64_t>(dataset.header().seed);
    fit.jobs = options.jobs;
    fit.interrupted = options.interrupted;
    if (options.progress)
        fit.progress = [&](const std::string& stage, int done, int total) {
            options.progress({source.name + ": " + stage, done, total, 0});
        };
    return {source.name,
            fit_mu(dataset.header().mesh, samples_of(dataset, source, 0), samples_of(dataset, source, 1), fit)};
}

}  // namespace toile::evaluate
