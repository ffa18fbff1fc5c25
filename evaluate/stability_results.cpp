#include "evaluate/stability_results.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "cloth/error.h"

namespace toile::evaluate {
namespace {

nlohmann::ordered_json number(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json as_json(const StabilityOutcome& one) {
    const simulate::Certificate& c = one.certificate;
    return {{"group", one.group},
            {"case", one.name},
            {"solver", one.solver},
            {"passed", one.passed()},
            {"status", one.status},
            {"at_rest_within_gate", one.rests},
            {"finite", one.finite},
            {"energy_measured", !std::isnan(one.energy_rise)},
            {"energy_never_rises", one.falling},
            {"energy_largest_rise", number(one.energy_rise)},
            {"residual_force", number(c.residual_force)},
            {"max_speed", number(c.max_speed)},
            {"body_penetration", number(c.body_penetration)},
            {"self_intersections", c.self_intersections},
            {"min_stretch", number(c.min_stretch)},
            {"max_stretch", number(c.max_stretch)},
            {"vertices", one.vertices},
            {"iterations", one.iterations},
            {"seconds", number(c.seconds)}};
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

StabilityOutcome from_json(const nlohmann::json& row) {
    const auto real = [&](const char* key) {
        const nlohmann::json& value = row.at(key);
        return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
    };
    StabilityOutcome one;
    row.at("group").get_to(one.group);
    row.at("case").get_to(one.name);
    row.at("solver").get_to(one.solver);
    row.at("status").get_to(one.status);
    row.at("at_rest_within_gate").get_to(one.rests);
    row.at("finite").get_to(one.finite);
    row.at("energy_never_rises").get_to(one.falling);
    row.at("self_intersections").get_to(one.certificate.self_intersections);
    row.at("vertices").get_to(one.vertices);
    row.at("iterations").get_to(one.iterations);
    one.energy_rise = real("energy_largest_rise");
    one.certificate.residual_force = real("residual_force");
    one.certificate.max_speed = real("max_speed");
    one.certificate.body_penetration = real("body_penetration");
    one.certificate.min_stretch = real("min_stretch");
    one.certificate.max_stretch = real("max_stretch");
    one.certificate.seconds = real("seconds");
    return one;
}

}  // namespace

std::string stability_json(const std::vector<StabilityOutcome>& outcomes) {
    const nlohmann::ordered_json document{
        {"format", "toile"}, {"kind", "stability"}, {"program_version", TOILE_VERSION}, {"cases", as_list(outcomes)}};
    return document.dump(2) + "\n";
}

std::string stability_csv(const std::vector<StabilityOutcome>& outcomes) {
    return outcomes.empty() ? "" : as_csv(as_list(outcomes));
}

std::vector<StabilityOutcome> read_stability_results(const std::string& path) {
    std::vector<StabilityOutcome> outcomes;
    try {
        const nlohmann::json document = nlohmann::json::parse(std::ifstream(path));
        if (document.at("kind") != "stability") throw Error("it holds something else");
        for (const nlohmann::json& row : document.at("cases")) outcomes.push_back(from_json(row));
    } catch (const std::exception& failure) {
        throw Error(std::string("not a table of the stability suite that could be resumed: ") + failure.what(), path,
                    "remove it, or leave out --resume");
    }
    return outcomes;
}

}  // namespace toile::evaluate
