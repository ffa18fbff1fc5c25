#include "evaluate/report_facts.h"

#include <algorithm>
#include <map>

namespace toile::evaluate {
namespace {

struct Telling {
    std::string kind, value;
};

/// Names of about lines as people read them.
std::string title(const std::string& name) {
    static const std::map<std::string, std::string> known{{"dataset", "data set"},
                                                          {"config_hash", "configuration hash"}};
    if (const auto found = known.find(name); found != known.end()) return found->second;
    std::string text = name;
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

}  // namespace

std::vector<ReportFact> report_facts(const std::vector<files::MetricFile>& evaluations) {
    std::vector<std::string> order;
    std::map<std::string, std::vector<Telling>> tellings;
    const auto tell = [&](const std::string& kind, const std::string& name, const std::string& value) {
        if (value.empty()) return;
        if (!tellings.contains(name)) order.push_back(name);
        tellings[name].push_back({kind, value});
    };
    for (const files::MetricFile& one : evaluations) {
        for (const files::MetricFile::Line& line : one.about)
            if (line.name != "program_version") tell(one.kind, line.name, line.value);
        tell(one.kind, "program_version", one.program_version);
    }
    std::vector<ReportFact> facts;
    for (const std::string& name : order) {
        const std::vector<Telling>& all = tellings[name];
        const bool agree = std::all_of(all.begin(), all.end(),
                                       [&](const Telling& telling) { return telling.value == all.front().value; });
        if (agree)
            facts.push_back({title(name), all.front().value});
        else
            for (const Telling& telling : all) facts.push_back({title(name) + ", " + telling.kind, telling.value});
    }
    return facts;
}

std::string told_about(const std::vector<files::MetricFile>& evaluations, const std::string& name) {
    for (const files::MetricFile& one : evaluations)
        for (const files::MetricFile::Line& line : one.about)
            if (line.name == name && !line.value.empty()) return line.value;
    return {};
}

}  // namespace toile::evaluate
