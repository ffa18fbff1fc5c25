#include <algorithm>
#include <cmath>

#include "cloth/error.h"
#include "files/predictions_file.h"
#include "files/split.h"

namespace toile::files {
namespace {

constexpr size_t most_listed = 5;

/// "3 of 12: 4, 7, 9", or the first few of them.
std::string list_of(const std::vector<int64_t>& id) {
    std::string text;
    for (size_t i = 0; i < std::min(id.size(), most_listed); ++i) text += (i > 0 ? ", " : "") + std::to_string(id[i]);
    return text + (id.size() > most_listed ? " ..." : "");
}

std::string number_of(size_t count, const char* one, const char* many) {
    return count == 1 ? one : std::to_string(count) + " " + many;
}

void check_ids(const PredictionsReader& predictions, const DatasetReader& dataset) {
    std::vector<int64_t> known = dataset.file().read<int64_t>("/samples/id", {any_size}).value;
    std::sort(known.begin(), known.end());
    std::vector<int64_t> strange;
    for (const int64_t id : predictions.id())
        if (!std::binary_search(known.begin(), known.end(), id)) strange.push_back(id);
    if (!strange.empty())
        throw Error(number_of(strange.size(), "a prediction is", "predictions are") + " of no sample of " +
                        dataset.file().path() + ": id " + list_of(strange),
                    predictions.path() + ":/samples/id", "ids are those of the data set's /samples/id");
}

void check_origin(const PredictionsReader& predictions, const DatasetReader& dataset) {
    const std::string& hash = predictions.header().dataset_config_hash;
    if (!hash.empty() && hash != dataset.header().config_hash)
        throw Error("the predictions are of another data set: its config_hash is " + hash + ", not " +
                        dataset.header().config_hash,
                    predictions.path() + ":dataset_config_hash", "predict " + dataset.file().path());
}

/// The names of the splits that have accepted samples.
std::string splits_there(const DatasetReader& dataset) {
    std::string text;
    for (int split = 0; split < static_cast<int>(split_name.size()); ++split)
        if (!accepted_ids(dataset, {split}).empty())
            text += (text.empty() ? "" : ", ") + std::string(split_name[static_cast<size_t>(split)]);
    return text;
}

void check_split(const PredictionsReader& predictions, const DatasetReader& dataset, int split) {
    const std::string name = split_name.at(static_cast<size_t>(split));
    const std::vector<int64_t> wanted = accepted_ids(dataset, {split});
    if (wanted.empty()) {
        const std::string there = splits_there(dataset);
        throw Error("the data set has no accepted sample in the split " + name, dataset.file().path(),
                    there.empty() ? "it has no accepted sample at all" : "choose with --split from: " + there);
    }
    std::vector<int64_t> missing;
    for (const int64_t id : wanted)
        if (!predictions.has(id)) missing.push_back(id);
    if (!missing.empty())
        throw Error(std::to_string(missing.size()) + " of " + std::to_string(wanted.size()) +
                        " accepted samples of the split " + name + " are not predicted: id " + list_of(missing),
                    predictions.path() + ":/samples/id", "predict them, or choose other splits with --split");
    for (const int64_t id : wanted)
        if (!predictions.read(id).allFinite())
            throw Error("the prediction of sample " + std::to_string(id) + " is not finite",
                        predictions.path() + ":/samples/predicted",
                        "NaN and infinity cannot be judged: predict it again");
}

}  // namespace

std::vector<int64_t> accepted_ids(const DatasetReader& dataset, const std::vector<int>& splits) {
    const std::vector<int64_t> id = dataset.file().read<int64_t>("/samples/id", {any_size}).value;
    const std::vector<int> split = dataset.file().read<int>("/samples/split", {any_size}).value;
    const std::vector<int> status = dataset.file().read<int>("/samples/status", {any_size}).value;
    if (split.size() != id.size() || status.size() != id.size())
        throw Error("/samples/id, /samples/split and /samples/status are of different lengths", dataset.file().path());
    std::vector<int64_t> accepted;
    for (size_t i = 0; i < id.size(); ++i)
        if (status[i] == 0 && std::find(splits.begin(), splits.end(), split[i]) != splits.end())
            accepted.push_back(id[i]);
    return accepted;
}

void check_predictions(const PredictionsReader& predictions, const DatasetReader& dataset,
                       const std::vector<int>& splits) {
    if (predictions.sample_count() == 0)
        throw Error("the file holds no predictions", predictions.path() + ":/samples/id");
    const int vertices = dataset.header().mesh.vertex_count();
    if (predictions.vertex_count() != vertices)
        throw Error("predictions have " + std::to_string(predictions.vertex_count()) + " vertices, the data set " +
                        std::to_string(vertices),
                    predictions.path() + ":/samples/predicted", "predict the mesh of " + dataset.file().path());
    check_origin(predictions, dataset);
    check_ids(predictions, dataset);
    for (const int split : splits) check_split(predictions, dataset, split);
}

}  // namespace toile::files
