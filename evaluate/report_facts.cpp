#include "evaluate/report_facts.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <utility>

namespace toile::evaluate {
namespace {

/// What does not belong to one evaluation alone, in the order it is told in, with the words for people.
constexpr std::array shared{std::pair{"dataset", "data set"},
                            std::pair{"config_hash", "configuration hash"},
                            std::pair{"samples by split", "samples judged"},
                            std::pair{"vertices", "vertices"},
                            std::pair{"program_version", "program version"},
                            std::pair{"processor", "processor"},
                            std::pair{"cores", "cores"},
                            std::pair{"machine", "machine"},
                            std::pair{"compiler", "compiler"},
                            std::pair{"build", "build"}};

struct Telling {
    std::string kind, value;
};

/// Tellings by name, in the order they were told.
class Tellings {
  public:
    Tellings() {
        for (const auto& [name, words] : shared) told_.push_back({name, words, {}, true});
    }
    void tell(const std::string& kind, const std::string& name, const std::string& value) {
        if (value.empty()) return;
        for (Told& one : told_)
            if (one.name == name) {
                one.tellings.push_back({kind, value});
                return;
            }
        std::string words = name;
        std::replace(words.begin(), words.end(), '_', ' ');
        told_.push_back({name, words, {{kind, value}}, false});
    }
    std::vector<ReportFact> facts() const {
        std::vector<ReportFact> facts;
        for (const Told& one : told_) {
            const bool agree = std::all_of(one.tellings.begin(), one.tellings.end(), [&](const Telling& telling) {
                return telling.value == one.tellings.front().value;
            });
            if (agree && !one.tellings.empty() && (one.shared || one.tellings.size() > 1))
                facts.push_back({one.words, one.tellings.front().value});
            else
                for (const Telling& telling : one.tellings)
                    facts.push_back({one.words + ", " + telling.kind, telling.value});
        }
        return facts;
    }

  private:
    struct Told {
        std::string name, words;
        std::vector<Telling> tellings;
        bool shared;
    };
    std::vector<Told> told_;
};

void tell_samples(Tellings& tellings, const AccuracyDocument& accuracy) {
    std::string splits;
    for (const AccuracyDocument::Split& one : accuracy.split)
        splits += fmt::format("{}{} {} of {}", splits.empty() ? "" : ", ", one.name, one.judged, one.samples);
    tellings.tell("accuracy", "samples by split", splits);
    tellings.tell("accuracy", "vertices", std::to_string(accuracy.vertices));
}

}  // namespace

std::vector<ReportFact> report_facts(const std::vector<files::MetricFile>& evaluations,
                                     const std::optional<AccuracyDocument>& accuracy) {
    Tellings tellings;
    if (accuracy) tell_samples(tellings, *accuracy);
    for (const files::MetricFile& one : evaluations) {
        for (const files::MetricFile::Line& line : one.about)
            if (line.name != "program_version" && !(line.name == "vertices" && one.kind == "accuracy"))
                tellings.tell(one.kind, line.name, line.value);
        tellings.tell(one.kind, "program_version", one.program_version);
    }
    return tellings.facts();
}

std::string told_about(const std::vector<files::MetricFile>& evaluations, const std::string& name) {
    for (const files::MetricFile& one : evaluations)
        for (const files::MetricFile::Line& line : one.about)
            if (line.name == name && !line.value.empty()) return line.value;
    return {};
}

}  // namespace toile::evaluate
