#include "evaluate/accuracy_document.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

double number(const Json& json) {
    return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

AccuracyDocument::Predictor predictor_of(const Json& json) {
    AccuracyDocument::Predictor predictor{json.at("name"), {}, json.value("mu_sentence", std::string())};
    for (const Json& one : json.at("methods"))
        predictor.method.push_back({one.at("method"), one.at("title"), number(one.at("setting"))});
    if (predictor.method.empty()) throw Json::other_error::create(501, "a predictor without methods", &json);
    return predictor;
}

void read_own(const Json& own, AccuracyDocument& document) {
    document.vertices = own.at("vertices");
    document.overstretched_limit = number(own.at("overstretched_limit"));
    for (const Json& one : own.at("predictors")) document.predictor.push_back(predictor_of(one));
    for (const Json& one : own.at("splits"))
        document.split.push_back({one.at("name"), one.at("samples"), one.at("accepted"), one.at("judged")});
    document.remark = own.at("remarks").get<std::vector<std::string>>();
    document.failures = own.at("failures").size();
    document.has_floor = !own.at("noise_floor").is_null();
    for (const Json& one : own.at("comparisons"))
        document.verdict[{one.at("predictor"), one.at("split"), one.at("method"), one.at("quantity")}] = {
            number(one.at("difference")), number(one.at("interval").at(0)), number(one.at("interval").at(1)),
            one.at("judgement")};
}

}  // namespace

const files::Metric* AccuracyDocument::find(const std::string& predictor_name, const std::string& split_name,
                                            const std::string& method, Quantity quantity) const {
    const auto found = metric.find("accuracy/" + predictor_name + "/" + split_name + "/" + method + "/" +
                                   quantity_kind(quantity).name);
    return found == metric.end() ? nullptr : &found->second;
}

const AccuracyDocument::Verdict* AccuracyDocument::verdict_on(const std::string& predictor_name,
                                                              const std::string& split_name, const std::string& method,
                                                              Quantity quantity) const {
    const auto found = verdict.find({predictor_name, split_name, method, quantity_kind(quantity).name});
    return found == verdict.end() ? nullptr : &found->second;
}

AccuracyDocument read_accuracy_document(const std::string& path) {
    const Json json = files::read_metric_document(path, "accuracy");
    const files::MetricFile file = files::as_metric_file(json, path, "accuracy");
    AccuracyDocument document;
    for (const auto& [name, value] : file.about) {
        if (name == "dataset") document.dataset = value;
        if (name == "command") document.command = value;
    }
    for (const files::Metric& one : file.metric) document.metric[one.name] = one;
    try {
        read_own(json.at("accuracy"), document);
    } catch (const Json::exception& error) {
        throw Error(std::string("what an accuracy evaluation leaves is not there: ") + error.what(), path + ":accuracy",
                    "evaluate it again with this version");
    }
    return document;
}

}  // namespace toile::evaluate
