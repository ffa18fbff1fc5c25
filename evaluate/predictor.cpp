#include "evaluate/predictor.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "evaluate/image_predictor.h"
#include "evaluate/mean_predictor.h"
#include "evaluate/nearest_predictor.h"
#include "evaluate/ridge_predictor.h"

namespace toile::evaluate {
namespace {

constexpr int most_components = 10000;

void need_train_split(const PredictorData& data) {
    if (data.train().empty())
        throw Error("the data set has no accepted sample in the train split, on which predictors are fitted",
                    data.dataset().file().path() + ":/samples/split",
                    "generate one with less in [split] validation and test, or more poses");
}

std::string list_of(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

void PredictorOptions::validate() const {
    const auto refuse = [](const std::string& option, const std::string& value, const std::string& may) {
        throw Error(option + " is " + value + ", and must be " + may, option);
    };
    if (std::find(predictor_names().begin(), predictor_names().end(), predictor) == predictor_names().end())
        refuse("predictor", "\"" + predictor + "\"", "one of " + list_of(predictor_names()));
    if (components < 0 || components > most_components)
        refuse("components", std::to_string(components), "0 to " + std::to_string(most_components));
    if (!(explained_variance > 0 && explained_variance <= 1))
        refuse("explained_variance", std::to_string(explained_variance), "above 0 and at most 1");
    if (ridge && !(*ridge >= 0 && std::isfinite(*ridge)))
        refuse("ridge", std::to_string(*ridge), "0 or more, and finite");
    if (jobs < 1) refuse("jobs", std::to_string(jobs), "1 or more");
}

std::vector<Positions> Predictor::displacements(std::span<const PredictorInput> input, int jobs) const {
    std::vector<Positions> result(input.size());
    parallel_for(static_cast<int>(input.size()), jobs,
                 [&](int, int i) { result[static_cast<size_t>(i)] = displacement(input[static_cast<size_t>(i)]); });
    return result;
}

const std::vector<std::string>& predictor_names() {
    static const std::vector<std::string> names = {"ridge", "mean", "nearest", "image"};
    return names;
}

std::unique_ptr<Predictor> fit_predictor(const PredictorOptions& options, const PredictorData& data) {
    options.validate();
    if (options.predictor == "image") return make_image_predictor(data);
    need_train_split(data);
    if (options.predictor == "mean") return fit_mean(data);
    if (options.predictor == "nearest") return fit_nearest(data);
    return fit_ridge_predictor(options, data);
}

Positions predicted_cloth(const Predictor& predictor, const files::SampleRecord& sample) {
    PredictorInput input{sample.id, sample.pose, {}};
    if (predictor.needs_image()) input.image = sample.image;
    return pattern::displaced({sample.embedded, sample.frame}, predictor.displacement(input));
}

}  // namespace toile::evaluate
