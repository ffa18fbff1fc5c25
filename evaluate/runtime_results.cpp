#include "evaluate/runtime_results.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "files/metric_file.h"

namespace toile::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
double number(const Json& json) {
    return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json as_json(const Spread& spread) {
    return Json::array({number(spread.low), number(spread.middle), number(spread.high)});
}
Spread spread(const Json& json) {
    return {number(json.at(0)), number(json.at(1)), number(json.at(2))};
}

Json as_json(const StudyAxis& axis) {
    return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}};
}
StudyAxis axis(const Json& json) {
    return {json.at("label"), json.at("unit"), json.at("log")};
}

Json as_json(const StudyCurves& curves) {
    Json series = Json::array();
    for (const StudySeries& one : curves.series) {
        Json point = Json::array();
        for (const StudyPoint& each : one.point)
            point.push_back({{"label", each.label}, {"x", as_json(each.x)}, {"y", as_json(each.y)}});
        series.push_back({{"name", one.name}, {"point", point}});
    }
    return {{"id", curves.id},        {"title", curves.title},  {"note", curves.note},
            {"x", as_json(curves.x)}, {"y", as_json(curves.y)}, {"series", series}};
}
StudyCurves curves(const Json& json) {
    StudyCurves result{json.at("id"), json.at("title"), json.at("note"), axis(json.at("x")), axis(json.at("y")), {}};
    for (const Json& one : json.at("series")) {
        StudySeries& series = result.series.emplace_back();
        series.name = one.at("name");
        for (const Json& each : one.at("point"))
            series.point.push_back({each.at("label"), spread(each.at("x")), spread(each.at("y"))});
    }
    return result;
}

Json as_json(const StudyCell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    if (const auto* value = std::get_if<double>(&cell)) return number(*value);
    return as_json(std::get<Spread>(cell));
}
StudyCell cell(const Json& json) {
    if (json.is_string()) return json.get<std::string>();
    if (json.is_array()) return spread(json);
    return number(json);
}

Json as_json(const StudyTable& table) {
    Json column = Json::array(), row = Json::array();
    for (const StudyColumn& one : table.column) column.push_back({{"name", one.name}, {"unit", one.unit}});
    for (const std::vector<StudyCell>& one : table.row) {
        Json cells = Json::array();
        for (const StudyCell& each : one) cells.push_back(as_json(each));
        row.push_back(cells);
    }
    return {{"id", table.id}, {"title", table.title}, {"note", table.note}, {"column", column}, {"row", row}};
}
StudyTable table(const Json& json) {
    StudyTable result{json.at("id"), json.at("title"), json.at("note"), {}, {}};
    for (const Json& one : json.at("column")) result.column.push_back({one.at("name"), one.at("unit")});
    for (const Json& one : json.at("row")) {
        std::vector<StudyCell>& row = result.row.emplace_back();
        for (const Json& each : one) row.push_back(cell(each));
        if (row.size() != result.column.size()) throw Error("a row of " + result.id + " does not fit its columns");
    }
    return result;
}

Study study_from(const Json& json) {
    Study study;
    study.name = json.at("name");
    study.title = json.at("title");
    study.text = json.at("text").get<std::vector<std::string>>();
    study.left_out = json.at("left_out").get<std::vector<std::string>>();
    study.refused = json.at("refused");
    for (const Json& one : json.at("curves")) study.curves.push_back(curves(one));
    for (const Json& one : json.at("table")) study.table.push_back(table(one));
    return study;
}

}  // namespace

nlohmann::ordered_json studies_as_json(const std::vector<Study>& study) {
    Json all = Json::array();
    for (const Study& one : study) {
        Json curves = Json::array(), table = Json::array();
        for (const StudyCurves& each : one.curves) curves.push_back(as_json(each));
        for (const StudyTable& each : one.table) table.push_back(as_json(each));
        all.push_back({{"name", one.name},
                       {"title", one.title},
                       {"text", one.text},
                       {"left_out", one.left_out},
                       {"refused", one.refused},
                       {"curves", curves},
                       {"table", table}});
    }
    return all;
}

std::vector<Study> studies_from_json(const nlohmann::ordered_json& json, const std::string& where) {
    try {
        std::vector<Study> all;
        for (const Json& one : json) all.push_back(study_from(one));
        return all;
    } catch (const nlohmann::json::exception&) {
        throw Error("the studies of error against run time are damaged", where + ":study",
                    "measure them again: toile evaluate runtime");
    } catch (const Error& error) {
        throw Error(error.what(), where + ":study", "measure them again: toile evaluate runtime");
    }
}

void write_runtime_results(const RuntimeSummary& summary, const RuntimeOptions& options, const RuntimeSamples& samples,
                           const std::vector<MachineFact>& machine) {
    files::MetricFile file;
    file.kind = "runtime";
    file.about = {
        {"dataset", options.dataset},
        {"command", options.command},
        {"config_hash", samples.header.config_hash},
        {"samples", std::to_string(samples.count())},
        {"vertices", std::to_string(samples.vertex_count())},
        {"predictions", samples.predictions},
        {"seed", std::to_string(options.predictions.seed)},
        {"quick", options.quick ? "yes" : "no"},
        {"intervals",
         "of seconds and errors the quartiles over the samples, of ratios the smallest and the largest round"}};
    for (const MachineFact& fact : machine) file.about.push_back({fact.name, fact.value});
    for (const Study& study : summary.study)
        file.metric.insert(file.metric.end(), study.metric.begin(), study.metric.end());
    files::write_metric_file(summary.file, file, Json{{"study", studies_as_json(summary.study)}});
}

}  // namespace toile::evaluate
