#include "evaluate/accuracy_story.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

const files::Metric* find_metric(const files::MetricFile& file, const std::string& name) {
    for (const files::Metric& metric : file.metric)
        if (metric.name == name) return &metric;
    return nullptr;
}

double number(const Json& value) {
    return value.is_null() ? files::Metric::missing : value.get<double>();
}

/// The split that the verdict is about: that of test, where it was judged.
std::string judged_split(const files::MetricFile& file, const std::string& predictor) {
    for (const char* split : {"test", "validation", "train"})
        if (find_metric(file, "accuracy/" + predictor + "/" + split + "/predicted/sqrt_mse")) return split;
    return "test";
}

AccuracyStory read_story(const Json& own, const files::MetricFile& file) {
    AccuracyStory story;
    for (const Json& split : own.at("splits")) {
        story.splits.push_back({split.at("name"), split.at("samples"), split.at("judged")});
        story.not_judged += split.at("samples").get<int>() - split.at("accepted").get<int>();
    }
    story.vertices = own.at("vertices");
    story.failures = static_cast<int>(own.at("failures").size());
    const Json& predictors = own.at("predictors");
    if (predictors.empty()) return story;
    const Json& first = predictors.at(0);
    story.predictor = first.at("name");
    story.split = judged_split(file, story.predictor);
    for (const Json& method : first.at("methods")) {
        AccuracyStory::Method one{method.at("method"), method.at("title"), number(method.at("setting")), nullptr, {}};
        one.error = find_metric(file, "accuracy/" + story.predictor + "/" + story.split + "/" + one.name + "/sqrt_mse");
        for (const Json& comparison : own.at("comparisons"))
            if (comparison.at("predictor") == story.predictor && comparison.at("split") == story.split &&
                comparison.at("method") == one.name && comparison.at("quantity") == "sqrt_mse")
                one.judgement = comparison.at("judgement");
        story.methods.push_back(std::move(one));
    }
    return story;
}

}  // namespace

const AccuracyStory::Method* AccuracyStory::find(const std::string& name, const std::string& beginning) const {
    const Method* begins = nullptr;
    for (const Method& method : methods) {
        if (!method.error || !std::isfinite(method.error->value)) continue;
        if (method.name == name) return &method;
        if (!begins && method.name.starts_with(beginning)) begins = &method;
    }
    return begins;
}

std::optional<AccuracyStory> accuracy_story(const std::string& folder,
                                            const std::vector<files::MetricFile>& evaluations) {
    const auto accuracy = std::find_if(evaluations.begin(), evaluations.end(),
                                       [](const files::MetricFile& file) { return file.kind == "accuracy"; });
    if (accuracy == evaluations.end()) return {};
    const std::string path = (std::filesystem::path(folder) / "accuracy.json").string();
    const Json document = files::read_metric_document(path, "accuracy");
    try {
        return read_story(document.at("accuracy"), *accuracy);
    } catch (const Json::exception&) {
        throw Error("the settings and comparisons of the accuracy are damaged", path + ":accuracy",
                    "measure it again: toile evaluate accuracy");
    }
}

}  // namespace toile::evaluate
