#include "evaluate/noise_section.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/metric_file.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

double number(const Json& value) {
    return value.is_null() ? not_there : value.get<double>();
}

std::vector<ReportCell> row_of(const Json& one, const std::string& what) {
    const auto millimetres = [&](const char* key) { return ReportCell(1e3 * number(one.at(key))); };
    std::vector<ReportCell> row{one.at("name").get<std::string>(), what};
    const bool drape = one.at("name") != "spread";
    row.push_back(drape ? ReportCell(one.at("accepted").get<int>()) : ReportCell());
    row.push_back(one.at("samples").get<int>());
    for (const char* key : {"median", "percentile_95", "percentile_99", "largest", "root_mean_square"})
        row.push_back(millimetres(key));
    row.push_back(drape ? ReportCell(number(one.at("seconds_a_drape"))) : ReportCell());
    return row;
}

ReportTable table_of(const Json& document) {
    using Align = ReportColumn::Align;
    ReportTable table{
        "noise-table",
        "Distance between two drapes of one pose",
        "Over vertices and samples that both drapes brought to rest. Spread: the largest distance over the "
        "variants, vertex by vertex.",
        {{"variant", "", Align::text},
         {"what differs", "", Align::text},
         {"accepted", ""},
         {"compared", ""},
         {"median", "mm"},
         {"95 %", "mm"},
         {"99 %", "mm"},
         {"largest", "mm"},
         {"root mean square", "mm"},
         {"a drape", "s"}}};
    for (const Json& one : document.at("variants")) table.rows.push_back(row_of(one, one.at("what")));
    table.rows.push_back(row_of(document.at("spread"), "the largest over the variants"));
    return table;
}

ReportHistogram histogram_of(const Json& histogram) {
    ReportHistogram block{"noise-histogram",
                          "How far apart vertices come to rest",
                          "Vertices of all samples compared, five bins a decade.",
                          {"distance", histogram.at("unit"), true}};
    for (const Json& one : histogram.at("series"))
        block.series.push_back({one.at("name"), histogram.at("edges"), one.at("counts")});
    return block;
}

ReportSection section_of(const Json& document) {
    ReportSection section{"noise", "Noise floor"};
    const Json& spread = document.at("spread");
    section.text.push_back(fmt::format(
        "The simulator's own error: {} of {} poses draped again with half the step, a finer tolerance and another "
        "solver. {} of {} drapes as configured came to rest. A difference between two results that is smaller than "
        "this cannot be told from the simulator's error.",
        document.at("samples").size(), document.at("poses").get<int>(), document.at("configured_accepted").get<int>(),
        document.at("samples").size()));
    if (spread.at("samples").get<int>() > 0)
        section.text.push_back(fmt::format(
            "The largest distance over the variants has a median of {:.3g} mm, a 95th percentile of {:.3g} mm and a "
            "root mean square of {:.3g} mm.",
            1e3 * number(spread.at("median")), 1e3 * number(spread.at("percentile_95")),
            1e3 * number(spread.at("root_mean_square"))));
    else
        section.text.push_back("No pose came to rest twice: there is no noise floor.");
    for (const Json& one : document.at("missing")) section.text.push_back("Left out: " + one.get<std::string>());
    section.blocks.push_back(table_of(document));
    if (!document.at("histogram").at("edges").empty()) section.blocks.push_back(histogram_of(document.at("histogram")));
    return section;
}

}  // namespace

std::optional<ReportSection> noise_section(const std::string& folder) {
    const std::string path = (std::filesystem::path(folder) / "noise.json").string();
    if (!std::filesystem::exists(path)) return std::nullopt;
    const Json document = files::read_metric_document(path, "noise");
    try {
        return section_of(document);
    } catch (const Json::exception& error) {
        throw Error("the noise floor lacks what a report shows of it", path, "measure it anew: toile evaluate noise");
    }
}

}  // namespace toile::evaluate
