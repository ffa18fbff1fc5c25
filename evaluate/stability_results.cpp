#include "evaluate/stability_results.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cloth/error.h"
#include "evaluate/stability_tally.h"

namespace toile::evaluate {
namespace {

nlohmann::ordered_json number(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

using Json = nlohmann::ordered_json;

/// What only a drape has, and what only a projected sample has: null in the other.
void add_drape(Json& row, const StabilityOutcome& one) {
    const simulate::Certificate& c = one.certificate;
    const bool drape = !one.prior;
    const auto put = [&](const char* key, Json value) { row[key] = drape ? std::move(value) : Json(nullptr); };
    put("at_rest_within_gate", one.rests);
    put("energy_measured", !std::isnan(one.energy_rise));
    put("energy_never_rises", one.falling);
    put("energy_largest_rise", number(one.energy_rise));
    put("max_speed", number(c.max_speed));
    put("body_penetration", number(c.body_penetration));
    put("self_intersections", c.self_intersections);
    put("min_stretch", number(c.min_stretch));
    put("max_stretch", number(c.max_stretch));
}

void add_sample(Json& row, const StabilityOutcome& one) {
    const StressOutcome none, &p = one.prior ? *one.prior : none;
    const auto put = [&](const char* key, Json value) { row[key] = one.prior ? std::move(value) : Json(nullptr); };
    put("tolerance", number(p.tolerance));
    put("says_converged", p.status == prior::Status::converged);
    put("failure", p.failure);
    put("derivative_tried", p.derivative_checked);
    put("derivative_says_accurate", p.derivative_claimed);
    put("derivative_identity_error", p.derivative_checked ? number(p.identity_error) : Json(nullptr));
    put("problem", p.problem);
    put("sample", p.sample);
    put("drawn", p.description);
}

Json as_json(const StabilityOutcome& one) {
    Json row{{"suite", one.prior ? "prior" : "simulator"},
             {"group", one.group},
             {"case", one.name},
             {"solver", one.solver},
             {"passed", one.passed()},
             {"false_claim", one.false_claim()},
             {"status", one.status},
             {"residual", number(one.residual())},
             {"seconds", number(one.certificate.seconds)},
             {"iterations", one.iterations},
             {"vertices", one.vertices},
             {"finite", one.finite}};
    add_drape(row, one);
    add_sample(row, one);
    row["replay"] = one.replay;
    row["command"] = one.command;
    return row;
}

/// One field of comma-separated values: text in quotes, quotes in it doubled.
std::string field(const nlohmann::ordered_json& value) {
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    std::string text = "\"";
    for (const char c : value.get<std::string>()) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
}

/// The fields of the JSON as rows of comma-separated values.
std::string as_csv(const nlohmann::ordered_json& list) {
    std::string text;
    for (const auto& [key, value] : list.at(0).items()) text += (text.empty() ? "" : ",") + key;
    for (const nlohmann::ordered_json& row : list) {
        std::string line;
        for (const auto& value : row) line += (line.empty() ? "" : ",") + field(value);
        text += "\n" + line;
    }
    return text + "\n";
}

nlohmann::ordered_json as_list(const std::vector<StabilityOutcome>& outcomes) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const StabilityOutcome& one : outcomes) list.push_back(as_json(one));
    return list;
}

double real(const nlohmann::json& row, const char* key) {
    const nlohmann::json& value = row.at(key);
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

void read_drape(const nlohmann::json& row, StabilityOutcome& one) {
    row.at("at_rest_within_gate").get_to(one.rests);
    row.at("energy_never_rises").get_to(one.falling);
    row.at("self_intersections").get_to(one.certificate.self_intersections);
    one.energy_rise = real(row, "energy_largest_rise");
    one.certificate.residual_force = real(row, "residual");
    one.certificate.max_speed = real(row, "max_speed");
    one.certificate.body_penetration = real(row, "body_penetration");
    one.certificate.min_stretch = real(row, "min_stretch");
    one.certificate.max_stretch = real(row, "max_stretch");
}

/// As far as it is judged and shown.
void read_sample(const nlohmann::json& row, StabilityOutcome& one) {
    StressOutcome& p = one.prior.emplace();
    p.residual = real(row, "residual");
    p.tolerance = real(row, "tolerance");
    p.status = row.at("says_converged").get<bool>() ? prior::Status::converged : prior::Status::accuracy_not_reached;
    p.finite = one.finite;
    row.at("failure").get_to(p.failure);
    row.at("derivative_tried").get_to(p.derivative_checked);
    row.at("derivative_says_accurate").get_to(p.derivative_claimed);
    p.identity_error = real(row, "derivative_identity_error");
    row.at("problem").get_to(p.problem);
    row.at("sample").get_to(p.sample);
    row.at("drawn").get_to(p.description);
}

StabilityOutcome from_json(const nlohmann::json& row) {
    StabilityOutcome one;
    row.at("group").get_to(one.group);
    row.at("case").get_to(one.name);
    row.at("solver").get_to(one.solver);
    row.at("status").get_to(one.status);
    row.at("finite").get_to(one.finite);
    row.at("vertices").get_to(one.vertices);
    row.at("iterations").get_to(one.iterations);
    row.at("replay").get_to(one.replay);
    row.at("command").get_to(one.command);
    one.certificate.seconds = real(row, "seconds");
    if (row.at("suite") == "prior")
        read_sample(row, one);
    else
        read_drape(row, one);
    if (row.at("passed") != one.passed()) throw Error("\"passed\" of \"" + one.name + "\" is not what its figures say");
    return one;
}

}  // namespace

void write_stability_results(const std::string& path, const std::vector<StabilityOutcome>& outcomes,
                             const std::vector<files::MetricFile::Line>& about) {
    const Json own{{"promises", {{"simulator", simulator_promise}, {"prior", prior_promise}}},
                   {"cases", as_list(outcomes)}};
    files::write_metric_file(path, {"stability", {}, about, stability_metrics(outcomes)}, own);
}

std::string stability_csv(const std::vector<StabilityOutcome>& outcomes) {
    return outcomes.empty() ? "" : as_csv(as_list(outcomes));
}

std::vector<StabilityOutcome> read_stability_results(const std::string& path) {
    const Json document = files::read_metric_document(path, "stability");
    std::vector<StabilityOutcome> outcomes;
    try {
        for (const Json& row : document.at("cases")) outcomes.push_back(from_json(row));
    } catch (const std::exception& failure) {
        throw Error(std::string("this is no table of the stability suites: ") + failure.what(), path);
    }
    return outcomes;
}

}  // namespace toile::evaluate
