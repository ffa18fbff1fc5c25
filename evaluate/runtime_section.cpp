#include "evaluate/runtime_section.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "evaluate/runtime_results.h"
#include "files/metric_file.h"

namespace toile::evaluate {
namespace {

bool drawable(double value, bool log) {
    return std::isfinite(value) && (!log || value > 0.0);
}

/// An end of a bar that a logarithmic axis has no place for is left out.
double bar_end(double value, bool log) {
    return drawable(value, log) ? value : not_there;
}

ReportCurves curves_block(const StudyCurves& curves) {
    ReportCurves block{curves.id,
                       curves.title,
                       curves.note,
                       {curves.x.label, curves.x.unit, curves.x.log},
                       {curves.y.label, curves.y.unit, curves.y.log}};
    int undrawn = 0;
    for (const StudySeries& series : curves.series) {
        ReportSeries& drawn = block.series.emplace_back();
        drawn.name = series.name;
        for (const StudyPoint& point : series.point) {
            if (!drawable(point.x.middle, curves.x.log) || !drawable(point.y.middle, curves.y.log)) {
                ++undrawn;
                continue;
            }
            drawn.points.push_back({point.x.middle, point.y.middle, bar_end(point.x.low, curves.x.log),
                                    bar_end(point.x.high, curves.x.log), bar_end(point.y.low, curves.y.log),
                                    bar_end(point.y.high, curves.y.log), point.label});
        }
    }
    std::erase_if(block.series, [](const ReportSeries& one) { return one.points.empty(); });
    if (undrawn > 0)
        block.note += (block.note.empty() ? "" : " ") + std::to_string(undrawn) +
                      " points at zero or without a number have no place on these axes; the table has them.";
    return block;
}

ReportCell report_cell(const StudyCell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    if (const auto* value = std::get_if<double>(&cell)) return *value;
    const Spread& spread = std::get<Spread>(cell);
    return Measured{spread.middle, spread.low, spread.high};
}

ReportTable table_block(const StudyTable& table) {
    ReportTable block{table.id, table.title, table.note, {}};
    for (size_t c = 0; c < table.column.size(); ++c) {
        const bool text = !table.row.empty() && std::holds_alternative<std::string>(table.row[0][c]);
        block.columns.push_back({table.column[c].name, table.column[c].unit,
                                 text ? ReportColumn::Align::text : ReportColumn::Align::number});
    }
    for (const std::vector<StudyCell>& row : table.row) {
        std::vector<ReportCell>& cells = block.rows.emplace_back();
        for (const StudyCell& cell : row) cells.push_back(report_cell(cell));
    }
    return block;
}

std::string about_line(const files::MetricFile& file) {
    std::string line;
    for (const files::MetricFile::Line& one : file.about)
        if (one.name == "processor" || one.name == "cores" || one.name == "load_at_start" || one.name == "compiler" ||
            one.name == "predictions")
            line += (line.empty() ? "" : "; ") + one.name + ": " + one.value;
    return line + ".";
}

}  // namespace

std::optional<ReportSection> runtime_section(const std::string& folder) {
    const std::string path = (std::filesystem::path(folder) / "runtime.json").string();
    if (!std::filesystem::exists(path)) return std::nullopt;
    const nlohmann::ordered_json document = files::read_metric_document(path, "runtime");
    if (!document.contains("study")) return std::nullopt;  // metrics alone: results.json has them
    ReportSection section{"runtime", "Error against run time"};
    section.text.push_back("All methods in one run on one machine, repeated in turns; " +
                           about_line(files::as_metric_file(document, path, "runtime")));
    for (const Study& study : studies_from_json(document.at("study"), path)) {
        for (const std::string& text : study.text) section.text.push_back(study.title + ". " + text);
        for (const std::string& text : study.left_out)
            section.text.push_back(study.title + ". Left out: " + text + ".");
        for (const StudyCurves& curves : study.curves) section.blocks.push_back(curves_block(curves));
        for (const StudyTable& table : study.table) section.blocks.push_back(table_block(table));
    }
    return section;
}

}  // namespace toile::evaluate
