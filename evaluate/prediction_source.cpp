#include "evaluate/prediction_source.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "cloth/error.h"
#include "evaluate/predictor.h"

namespace toile::evaluate {
namespace {

/// Empty where all accepted train samples are there, and finite.
std::string why_no_train(const files::PredictionsReader& reader, const files::DatasetReader& dataset,
                         const std::vector<int>& splits) {
    if (std::find(splits.begin(), splits.end(), 0) != splits.end()) return {};  // was checked with the others
    if (files::accepted_ids(dataset, {0}).empty()) return "the data set has no accepted train sample";
    try {
        files::check_predictions(reader, dataset, {0});
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

PredictionSource from_file(const std::string& path, const files::DatasetReader& dataset,
                           const std::vector<int>& splits) {
    const auto reader = std::make_shared<const files::PredictionsReader>(path);
    files::check_predictions(*reader, dataset, splits);
    return {reader->predictor(), path, [reader](const files::SampleRecord& sample) { return reader->read(sample.id); },
            why_no_train(*reader, dataset, splits)};
}

/// A predictor with the data it was fitted on.
struct Fitted {
    PredictorData data;
    std::unique_ptr<Predictor> predictor;

    Fitted(const files::DatasetReader& dataset, const std::string& name) : data(dataset) {
        PredictorOptions options;
        options.predictor = name;
        options.seed = static_cast<std::uint64_t>(dataset.header().seed);
        predictor = fit_predictor(options, data);
    }
};

std::vector<PredictionSource> built_in_sources(const files::DatasetReader& dataset) {
    std::vector<PredictionSource> sources;
    for (const std::string& name : predictor_names()) {
        if (name == "image" && !dataset.header().image) continue;
        const auto fitted = std::make_shared<const Fitted>(dataset, name);
        sources.push_back(
            {name,
             "built in",
             [fitted](const files::SampleRecord& sample) { return predicted_cloth(*fitted->predictor, sample); },
             {}});
    }
    return sources;
}

}  // namespace

std::vector<PredictionSource> prediction_sources(const std::vector<std::string>& paths,
                                                 const files::DatasetReader& dataset, const std::vector<int>& splits) {
    std::vector<PredictionSource> sources;
    if (paths.empty()) return built_in_sources(dataset);
    std::set<std::string> names{"target"};  // the truth's own row
    for (const std::string& path : paths) {
        sources.push_back(from_file(path, dataset, splits));
        if (!names.insert(sources.back().name).second)
            throw Error("\"" + sources.back().name + "\" names another predictor already", path,
                        "give the file another attribute predictor, or another name");
    }
    return sources;
}

}  // namespace toile::evaluate
