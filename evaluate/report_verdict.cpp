#include "evaluate/report_verdict.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <string_view>

#include "evaluate/accuracy_story.h"
#include "evaluate/report_facts.h"

namespace toile::evaluate {
namespace {

using Method = AccuracyStory::Method;

const files::MetricFile* find_kind(const std::vector<files::MetricFile>& evaluations, const std::string& kind) {
    for (const files::MetricFile& one : evaluations)
        if (one.kind == kind) return &one;
    return nullptr;
}

/// "7.43 mm (95 %: 7.1 to 7.8)".
std::string measured(const files::Metric& metric) {
    std::string text = fmt::format("{:.3g} {}", metric.value, metric.unit);
    if (metric.low < metric.value || metric.high > metric.value)
        text += fmt::format(" (95 %: {:.3g} to {:.3g})", metric.low, metric.high);
    return text;
}

/// What a method does to the error: "; 7.2 mm … after the quasistatic prior, μ = 0.1, better by 0.2 mm".
std::string change(const Method& method, const Method& before) {
    std::string text = fmt::format("; {} {}", measured(*method.error), method.title);
    const double difference = method.error->value - before.error->value;
    const std::string amount = fmt::format("{:.2g} {}", std::abs(difference), method.error->unit);
    if (method.judgement == "better" || method.judgement == "worse")
        return text + fmt::format(", {} by {}", method.judgement, amount);
    if (method.judgement.empty()) return text;
    return text + fmt::format(", {} {}: {}", amount, difference < 0.0 ? "less" : "more", method.judgement);
}

std::string error_line(const std::optional<AccuracyStory>& story) {
    if (!story) return "Error: not measured; `toile evaluate accuracy` measures it.";
    const Method* before = story->find("predicted", "predicted");
    if (!before) return "Error: no predictor was judged.";
    std::string line = fmt::format("Error on {} ({}, SqrtMSE): {} as predicted", story->split, story->predictor,
                                   measured(*before->error));
    const Method* limited = story->find("inextensibility@limit=0", "inextensibility@");
    const Method* balanced = story->find("quasistatic@mu=best", "quasistatic@mu=0.1");
    if (!balanced) balanced = story->find("quasistatic@mu=0.1", "quasistatic@");
    line += limited ? change(*limited, *before) : "; the inextensibility prior was not judged";
    line += balanced ? change(*balanced, *before) : "; the quasistatic prior was not judged";
    if (before->error->floor && std::isfinite(*before->error->floor))
        line += fmt::format(". The simulator's own noise is {:.2g} {}", *before->error->floor, before->error->unit);
    else
        line += ". The simulator's own noise was not measured (`toile evaluate noise`)";
    return line + ".";
}

/// Of the values of μ that were tried, that of the least error.
const Method* best_tried(const AccuracyStory& story) {
    const Method* best = nullptr;
    for (const Method& method : story.methods) {
        const bool tried = method.name.starts_with("quasistatic@mu=") && method.error &&
                           std::isfinite(method.error->value) && std::isfinite(method.setting);
        if (tried && (!best || method.error->value < best->error->value)) best = &method;
    }
    return best;
}

std::string mu_line(const std::optional<AccuracyStory>& story) {
    const std::string begin = "Best μ of the quasistatic prior: ";
    if (!story) return begin + "not measured; `toile evaluate accuracy` measures it.";
    const Method* learned = story->find("quasistatic@mu=best", "quasistatic@mu=best");
    const Method* vertex = story->find("quasistatic@mu=vertex", "quasistatic@mu=vertex");
    if (!learned) {
        const Method* best = best_tried(*story);
        if (!best) return begin + "no value was tried.";
        return begin + fmt::format("none was learned; of those tried, {:.3g} has the least error on {}, {}.",
                                   best->setting, story->split, measured(*best->error));
    }
    std::string line = begin + fmt::format("{:.3g}, learned on train, {} on {}", learned->setting,
                                           measured(*learned->error), story->split);
    if (vertex) line += fmt::format("; learned per vertex, {}", measured(*vertex->error));
    return line + ".";
}

/// The fastest of a prior's methods at the tolerance that priors have by default, else at any; null where there is
/// none.
const files::Metric* fastest(const files::MetricFile& runtime, const std::string& prior) {
    const files::Metric* best = nullptr;
    bool at_default = false;
    for (const files::Metric& metric : runtime.metric) {
        if (!metric.name.starts_with("runtime/priors/" + prior) || !metric.name.ends_with("/seconds") ||
            !std::isfinite(metric.value))
            continue;
        const bool here = metric.name.find("@1e-06/") != std::string::npos;
        if (!best || (here && !at_default) || (here == at_default && metric.value < best->value)) {
            best = &metric;
            at_default = here;
        }
    }
    return best;
}

std::string cost(const files::MetricFile& runtime, const std::string& prior) {
    const files::Metric* metric = fastest(runtime, prior);
    if (!metric) return fmt::format("the {} prior was not timed", prior);
    const size_t begin = std::string("runtime/priors/").size(), end = metric->name.rfind('/');
    return fmt::format("the {} prior takes {:.3g} ms a sample ({})", prior, 1e3 * metric->value,
                       metric->name.substr(begin, end - begin));
}

std::string time_line(const std::vector<files::MetricFile>& evaluations) {
    const files::MetricFile* runtime = find_kind(evaluations, "runtime");
    if (!runtime) return "Time: not measured; `toile evaluate runtime` measures it.";
    std::string line = fmt::format("Time: {}, {}", cost(*runtime, "inextensibility"), cost(*runtime, "quasistatic"));
    if (const std::string vertices = told_about({*runtime}, "vertices"); !vertices.empty())
        line += ", at " + vertices + " vertices";
    return line + ".";
}

std::string plural(int count, const std::string& what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// "14 of 200 cases of the stability suite failed (xpbd 12, bullet 2)", from "stability/<solver>/passed_share".
std::string stability_words(const files::MetricFile& stability) {
    constexpr std::string_view begin = "stability/", end = "/passed_share";
    int cases = 0, failed = 0;
    std::string whose;
    for (const files::Metric& metric : stability.metric) {
        if (!metric.name.starts_with(begin) || !metric.name.ends_with(end) || !std::isfinite(metric.value)) continue;
        const int here = static_cast<int>(std::lround((1.0 - metric.value / 100.0) * metric.samples));
        cases += metric.samples;
        failed += here;
        const std::string solver = metric.name.substr(begin.size(), metric.name.size() - begin.size() - end.size());
        if (here > 0) whose += fmt::format("{}{} {}", whose.empty() ? "" : ", ", solver, here);
    }
    if (cases == 0) return "no case of the stability suite was run";
    if (failed == 0) return fmt::format("all {} cases of the stability suite passed", cases);
    return fmt::format("{} of {} cases of the stability suite failed ({})", failed, cases, whose);
}

std::string broken_line(const std::optional<AccuracyStory>& story, const std::vector<files::MetricFile>& evaluations) {
    std::string line = "What broke: ";
    if (story)
        line += fmt::format("{} of the data set not accepted, {} that a prior did not solve to its accuracy",
                            plural(story->not_judged, "sample"), plural(story->failures, "projection"));
    else
        line += "accuracy not measured";
    const files::MetricFile* stability = find_kind(evaluations, "stability");
    if (!stability) return line + "; stability not measured (`toile evaluate stability`).";
    return line + "; " + stability_words(*stability) + ".";
}

std::string baseline_line(const std::optional<BaselineComparison>& baseline) {
    return baseline ? baseline_verdict(*baseline) : "Baseline: none was given to compare with (--baseline FILE).";
}

}  // namespace

std::vector<std::string> report_verdict(const std::optional<AccuracyDocument>& accuracy,
                                        const std::vector<files::MetricFile>& evaluations,
                                        const std::optional<BaselineComparison>& baseline) {
    std::optional<AccuracyStory> story;
    if (accuracy) story = accuracy_story(*accuracy);
    return {error_line(story), mu_line(story), time_line(evaluations), broken_line(story, evaluations),
            baseline_line(baseline)};
}

}  // namespace toile::evaluate
