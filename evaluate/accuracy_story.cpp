#include "evaluate/accuracy_story.h"

#include <cmath>

namespace toile::evaluate {
namespace {

/// The split that the verdict is about: that of test, where it was judged.
std::string judged_split(const AccuracyDocument& document, const std::string& predictor) {
    for (const char* split : {"test", "validation", "train"})
        if (document.find(predictor, split, "predicted", Quantity::sqrt_mse)) return split;
    return "test";
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

AccuracyStory accuracy_story(const AccuracyDocument& document) {
    AccuracyStory story;
    story.failures = static_cast<int>(document.failures);
    for (const AccuracyDocument::Split& split : document.split) story.not_judged += split.samples - split.accepted;
    if (document.predictor.empty()) return story;
    const AccuracyDocument::Predictor& first = document.predictor.front();
    story.predictor = first.name;
    story.split = judged_split(document, first.name);
    for (const AccuracyDocument::Method& method : first.method) {
        const auto* verdict = document.verdict_on(first.name, story.split, method.name, Quantity::sqrt_mse);
        story.methods.push_back({method.name, method.title, method.setting,
                                 document.find(first.name, story.split, method.name, Quantity::sqrt_mse),
                                 verdict ? verdict->judgement : ""});
    }
    return story;
}

}  // namespace toile::evaluate
