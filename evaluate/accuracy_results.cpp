#include "evaluate/accuracy_results.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "evaluate/accuracy_file.h"
#include "evaluate/mu_picture.h"
#include "files/image_file.h"
#include "files/metric_file.h"
#include "files/new_file.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json as_json(const Comparison& one) {
    return {{"predictor", one.predictor},
            {"split", one.split},
            {"method", one.method},
            {"quantity", quantity_kind(one.quantity).name},
            {"difference", number(one.difference)},
            {"interval", {number(one.interval.low), number(one.interval.high)}},
            {"judgement", judgement_text(one.judgement)}};
}

Json as_json(const MuErrors& errors) {
    return {{"predicted", number(errors.predicted)},
            {"reference", number(errors.reference)},
            {"fitted", number(errors.fitted)}};
}

/// What was learned of μ, but for μ per vertex itself, which is in the arrays. Errors in metres.
Json as_json(const MuFit& fit) {
    Json history = Json::array(), tried = Json::array();
    for (const MuStep& one : fit.global.history)
        history.push_back({{"mu", number(one.mu)}, {"error", number(one.error)}});
    for (const MuSmoothness& one : fit.vertex.tried)
        tried.push_back({{"weight", number(one.weight)},
                         {"train", number(one.train)},
                         {"validation", number(one.validation)},
                         {"status", mu_status_name(one.status)}});
    Json json{{"samples", fit.samples},
              {"validation_samples", fit.validation_samples},
              {"global",
               {{"mu", number(fit.global.mu)},
                {"status", mu_status_name(fit.global.status)},
                {"train", as_json(fit.global.train)},
                {"validation", as_json(fit.global.validation)},
                {"history", std::move(history)}}}};
    if (fit.vertex.mu.size() > 0)
        json["vertex"] = {{"least", number(fit.vertex.mu.minCoeff())},
                          {"most", number(fit.vertex.mu.maxCoeff())},
                          {"status", mu_status_name(fit.vertex.status)},
                          {"smoothness", number(fit.vertex.smoothness)},
                          {"train", as_json(fit.vertex.train)},
                          {"validation", as_json(fit.vertex.validation)},
                          {"tried", std::move(tried)}};
    return json;
}

Json predictors_json(const AccuracySummary& summary) {
    Json predictors = Json::array();
    for (const PredictorFigures& predictor : summary.figures.predictor) {
        Json methods = Json::array();
        for (const MethodFigures& one : predictor.method)
            methods.push_back({{"method", one.method}, {"title", one.title}, {"setting", number(one.setting)}});
        predictors.push_back({{"name", predictor.predictor}, {"methods", std::move(methods)}});
        for (const LearnedMu& one : summary.mu) {
            if (one.predictor != predictor.predictor) continue;
            predictors.back()["mu_sentence"] = one.fit.sentence;
            predictors.back()["mu"] = as_json(one.fit);
        }
    }
    return predictors;
}

Json own_members(const AccuracyOptions& options, const AccuracySummary& summary) {
    Json splits = Json::array(), failures = Json::array(), comparisons = Json::array();
    for (const JudgedSplit& one : summary.split)
        splits.push_back({{"name", split_name(one.split)},
                          {"samples", one.there},
                          {"accepted", one.accepted},
                          {"judged", one.slot.size()}});
    for (const AccuracyFailure& one : summary.failure)
        failures.push_back({{"predictor", one.predictor}, {"method", one.method}, {"id", one.id}, {"what", one.what}});
    for (const Comparison& one : summary.verdicts.comparison) comparisons.push_back(as_json(one));
    Json floor = nullptr;
    if (summary.floor) {
        floor = {{"source", summary.floor->source}, {"pairs", summary.floor->samples}};
        for (int q = 0; q < quantity_count; ++q)
            floor[quantity_kind(q).name] = number(summary.floor->value[static_cast<size_t>(q)]);
    }
    return {{"accuracy",
             {{"vertices", summary.vertices},
              {"overstretched_limit", options.overstretched_limit},
              {"bootstrap_draws", Bootstrap::draws},
              {"splits", std::move(splits)},
              {"predictors", predictors_json(summary)},
              {"noise_floor", std::move(floor)},
              {"remarks", summary.remark},
              {"failures", std::move(failures)},
              {"comparisons", std::move(comparisons)}}}};
}

files::MetricFile metric_file(const AccuracyOptions& options, const files::DatasetHeader& header,
                              const AccuracySummary& summary) {
    files::MetricFile file;
    file.kind = "accuracy";
    file.about = {{"dataset", options.dataset}, {"config_hash", header.config_hash}, {"command", options.command}};
    std::string names;
    for (const PredictorFigures& one : summary.figures.predictor) names += (names.empty() ? "" : ", ") + one.predictor;
    file.about.push_back({"predictors", names});
    if (summary.floor) file.about.push_back({"noise", summary.floor->source});
    file.metric = summary.verdicts.metric;
    return file;
}

/// The methods that a short table tells of: the prediction, the strictest limit, the μ nearest to the paper's 0.1, and
/// what was learned.
std::set<std::string> told_methods(const PredictorFigures& predictor) {
    std::set<std::string> told{predictor.method.front().method, "quasistatic@mu=best", "quasistatic@mu=vertex"};
    const auto nearest = [&](const std::string& beginning, auto distance) {
        const MethodFigures* best = nullptr;
        for (const MethodFigures& one : predictor.method)
            if (one.method.starts_with(beginning) && (!best || distance(one.setting) < distance(best->setting)))
                best = &one;
        if (best) told.insert(best->method);
    };
    nearest("inextensibility@", [](double limit) { return limit; });
    nearest("quasistatic@", [](double mu) { return std::abs(std::log(mu / 0.1)); });
    return told;
}

/// Rows of one split's table.
class SplitTable {
  public:
    SplitTable(const AccuracySummary& summary, const JudgedSplit& split) : split_(split_name(split.split)) {
        for (const files::Metric& one : summary.verdicts.metric) metric_[one.name] = &one;
        for (const Comparison& one : summary.verdicts.comparison)
            if (one.split == split_ && one.quantity == Quantity::sqrt_mse)
                verdict_[{one.predictor, one.method}] = judgement_text(one.judgement);
        text_ = fmt::format("{}: {} samples\n{:<12} {:<28}{:>9}{:>9}{:>10}{:>10}{:>9}{:>8}{:>9}{:>8}  {}\n", split_,
                            split.slot.size(), "", "", "SqrtMSE", "MaxDist", "stretch", "compress", "normals", "over",
                            "largest", "inside", "SqrtMSE against");
        text_ += fmt::format("{:<12} {:<28}{:>9}{:>9}{:>10}{:>10}{:>9}{:>8}{:>9}{:>8}  {}\n", "predictor", "method",
                             "mm", "mm", "error, J", "error, J", "deg", "%", "ratio", "mm", "the prediction");
    }

    void add(const PredictorFigures& predictor) {
        const std::set<std::string> told = told_methods(predictor);
        for (const MethodFigures& method : predictor.method) {
            if (!told.contains(method.method)) continue;
            const auto cell = [&](Quantity quantity, int width, int digits) {
                const auto found = metric_.find("accuracy/" + predictor.predictor + "/" + split_ + "/" + method.method +
                                                "/" + quantity_kind(quantity).name);
                const bool known = found != metric_.end() && std::isfinite(found->second->value);
                return known ? fmt::format("{:>{}.{}f}", found->second->value, width, digits)
                             : fmt::format("{:>{}}", "-", width);
            };
            const auto verdict = verdict_.find({predictor.predictor, method.method});
            text_ += fmt::format("{:<12} {:<28}", predictor.predictor, method.method) + cell(Quantity::sqrt_mse, 9, 3) +
                     cell(Quantity::max_dist, 9, 2) + cell(Quantity::stretching_energy_error, 10, 4) +
                     cell(Quantity::compression_energy_error, 10, 4) + cell(Quantity::normal_error, 9, 2) +
                     cell(Quantity::overstretched_share, 8, 2) + cell(Quantity::largest_stretch, 9, 3) +
                     cell(Quantity::penetration, 8, 2) + (verdict == verdict_.end() ? "" : "  " + verdict->second) +
                     "\n";
        }
    }
    const std::string& text() const { return text_; }

  private:
    std::string split_, text_;
    std::map<std::string, const files::Metric*> metric_;
    std::map<std::pair<std::string, std::string>, std::string> verdict_;
};

/// mu.png beside the results: of the first predictor that mu was learned for, as in accuracy.h5. One of an earlier run
/// goes.
void write_mu_picture(const files::DatasetHeader& header, const AccuracySummary& summary) {
    const std::filesystem::path path = std::filesystem::path(summary.results).parent_path() / "mu.png";
    if (!summary.mu.empty() && summary.mu.front().fit.vertex.mu.size() > 0)
        files::write_png(path.string(), mu_picture(header.mesh, summary.mu.front().fit.vertex.mu));
    else
        std::filesystem::remove(path);
}

}  // namespace

void write_accuracy(const AccuracyOptions& options, const files::DatasetHeader& header, const Shown& shown,
                    const AccuracySummary& summary) {
    files::NewFile arrays(summary.figures_file);
    write_accuracy_file(arrays.partial(), header, shown, summary);
    write_mu_picture(header, summary);
    files::write_metric_file(summary.results, metric_file(options, header, summary), own_members(options, summary));
    arrays.commit();
}

std::string accuracy_table(const AccuracySummary& summary) {
    std::string text;
    for (const JudgedSplit& split : summary.split) {
        SplitTable table(summary, split);
        table.add(summary.figures.truth);
        for (const PredictorFigures& predictor : summary.figures.predictor) table.add(predictor);
        text += table.text() + "\n";
    }
    if (summary.floor)
        text += fmt::format("the simulator's noise: SqrtMSE {:.3f} mm, MaxDist {:.2f} mm\n",
                            at(summary.floor->value, Quantity::sqrt_mse), at(summary.floor->value, Quantity::max_dist));
    for (const std::string& one : summary.remark) text += one + "\n";
    return text;
}

}  // namespace toile::evaluate
