#include "evaluate/report_document.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json numbers(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number(value));
    return list;
}

struct CellJson {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(const std::string& text) const { return text; }
    Json operator()(double value) const { return number(value); }
    Json operator()(const Measured& one) const {
        Json cell{{"value", number(one.value)}, {"low", number(one.low)}, {"high", number(one.high)}};
        if (!one.note.empty()) cell["note"] = one.note;
        return cell;
    }
};

Json as_json(const ReportAxis& axis) {
    return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}};
}

Json as_json(const ReportPoint& point) {
    Json json{{"x", number(point.x)}, {"y", number(point.y)}};
    const std::pair<const char*, double> spread[] = {
        {"x_low", point.x_low}, {"x_high", point.x_high}, {"y_low", point.y_low}, {"y_high", point.y_high}};
    for (const auto& [key, value] : spread)
        if (std::isfinite(value)) json[key] = value;
    if (!point.label.empty()) json["label"] = point.label;
    return json;
}

struct BlockJson {
    Json operator()(const ReportTable& table) const {
        Json columns = Json::array(), rows = Json::array();
        for (const ReportColumn& column : table.columns)
            columns.push_back({{"name", column.name},
                               {"unit", column.unit},
                               {"align", column.align == ReportColumn::Align::text ? "text" : "number"},
                               {"digits", column.digits}});
        for (const std::vector<ReportCell>& row : table.rows) {
            if (row.size() != table.columns.size())
                throw Error("a row of the table has " + std::to_string(row.size()) + " cells for " +
                                std::to_string(table.columns.size()) + " columns",
                            table.id);
            Json cells = Json::array();
            for (const ReportCell& cell : row) cells.push_back(std::visit(CellJson{}, cell.value()));
            rows.push_back(std::move(cells));
        }
        return {{"type", "table"},    {"id", table.id},     {"title", table.title},
                {"note", table.note}, {"columns", columns}, {"rows", rows}};
    }
    Json operator()(const ReportCurves& curves) const {
        Json series = Json::array();
        for (const ReportSeries& one : curves.series) {
            Json points = Json::array();
            for (const ReportPoint& point : one.points) points.push_back(as_json(point));
            series.push_back({{"name", one.name}, {"points", points}});
        }
        return {{"type", "curves"},       {"id", curves.id},        {"title", curves.title}, {"note", curves.note},
                {"x", as_json(curves.x)}, {"y", as_json(curves.y)}, {"series", series}};
    }
    Json operator()(const ReportHistogram& histogram) const {
        Json series = Json::array();
        for (const ReportHistogram::Series& one : histogram.series) {
            if (one.edges.size() != one.counts.size() + 1)
                throw Error("a histogram has " + std::to_string(one.edges.size()) + " edges for " +
                                std::to_string(one.counts.size()) + " counts",
                            histogram.id);
            series.push_back({{"name", one.name}, {"edges", numbers(one.edges)}, {"counts", numbers(one.counts)}});
        }
        return {{"type", "histogram"},    {"id", histogram.id},        {"title", histogram.title},
                {"note", histogram.note}, {"x", as_json(histogram.x)}, {"series", series}};
    }
    Json operator()(const ReportPicture& picture) const {
        if (picture.src.rfind("data:image/", 0) != 0)
            throw Error("a picture must be in the page itself, as a data URI", picture.id);
        return {{"type", "picture"},
                {"id", picture.id},
                {"title", picture.title},
                {"alt", picture.alt},
                {"src", picture.src}};
    }
    Json operator()(const ReportViewer& viewer) const {
        return {{"type", "viewer"}, {"id", viewer.id}, {"title", viewer.title}};
    }
};

/// Ids become the page's anchors: each is there once.
void take_id(const std::string& id, const std::string& title, std::set<std::string>& ids) {
    if (id.empty()) throw Error("a part of the report has no id", title);
    if (!ids.insert(id).second) throw Error("two parts of the report have the same id", id);
}

Json as_json(const ReportSection& section, std::set<std::string>& ids) {
    take_id(section.id, section.title, ids);
    Json blocks = Json::array();
    for (const ReportBlock& block : section.blocks) {
        std::visit([&](const auto& one) { take_id(one.id, one.title, ids); }, block);
        blocks.push_back(std::visit(BlockJson{}, block));
    }
    return {{"id", section.id}, {"title", section.title}, {"text", section.text}, {"blocks", blocks}};
}

}  // namespace

Json as_json(const ReportSection& section) {
    std::set<std::string> ids;
    return as_json(section, ids);
}

Json as_json(const ReportDocument& document) {
    if (document.verdict.size() > 5) throw Error("the verdict has more than five lines", document.title);
    Json facts = Json::array(), sections = Json::array();
    std::set<std::string> ids;
    for (const ReportFact& fact : document.facts) facts.push_back({{"name", fact.name}, {"value", fact.value}});
    for (const ReportSection& section : document.sections) sections.push_back(as_json(section, ids));
    return {{"title", document.title},
            {"verdict", document.verdict},
            {"facts", facts},
            {"sections", sections},
            {"scene", nullptr}};
}

}  // namespace toile::evaluate
