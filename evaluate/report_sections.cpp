#include "evaluate/report_sections.h"

#include <optional>
#include <utility>

#include "evaluate/accuracy_section.h"
#include "evaluate/noise_section.h"
#include "evaluate/runtime_section.h"
#include "evaluate/stability_section.h"
#include "evaluate/strain_section.h"

namespace toile::evaluate {
namespace {

using SectionBuilder = std::optional<ReportSection> (*)(const std::string& folder);

}  // namespace

std::vector<ReportSection> report_sections(const std::string& folder) {
    const std::vector<SectionBuilder> builders{accuracy_section, runtime_section, stability_section, strain_section,
                                               noise_section};
    std::vector<ReportSection> sections;
    for (const SectionBuilder builder : builders)
        if (std::optional<ReportSection> section = builder(folder)) sections.push_back(std::move(*section));
    return sections;
}

}  // namespace toile::evaluate
