#include "files/metric_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <unordered_set>
#include <utility>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_name = "toile metrics";
constexpr int format_version = 1;
constexpr std::array direction_names{"lower", "higher", "none"};

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json as_json(const Metric& metric) {
    const bool interval = !std::isnan(metric.low) || !std::isnan(metric.high);
    Json row{
        {"metric", metric.name},
        {"value", number(metric.value)},
        {"interval", {number(interval ? metric.low : metric.value), number(interval ? metric.high : metric.value)}},
        {"unit", metric.unit},
        {"direction", direction_name(metric.direction)},
        {"tolerance", number(metric.tolerance)},
        {"samples", metric.samples}};
    if (metric.distribution)
        row["distribution"] = {{"median", number(metric.distribution->median)},
                               {"p95", number(metric.distribution->p95)},
                               {"p99", number(metric.distribution->p99)},
                               {"largest", number(metric.distribution->largest)}};
    if (metric.floor) row["floor"] = number(*metric.floor);
    return row;
}

/// An object of the document that is read: every complaint names the file and the key.
class Member {
  public:
    Member(const Json& value, std::string path, std::string key)
        : value_(value), path_(std::move(path)), key_(std::move(key)) {
        if (!value_.is_object()) fail("this must be an object");
    }

    [[noreturn]] void fail(const std::string& what, const std::string& name = {}) const {
        throw Error(what, path_ + ":" + key(name), "let this program's `toile evaluate` write it anew");
    }
    void only(std::initializer_list<const char*> names) const {
        for (const auto& item : value_.items())
            if (std::find(names.begin(), names.end(), item.key()) == names.end()) fail("unknown key", item.key());
    }
    bool has(const char* name) const { return value_.contains(name); }
    const Json& at(const char* name) const {
        const auto found = value_.find(name);
        if (found == value_.end()) fail("this key is missing", name);
        return *found;
    }
    Member member(const char* name) const { return {at(name), path_, key(name)}; }
    std::string text(const char* name) const {
        if (!at(name).is_string()) fail("this must be a text", name);
        return at(name).get<std::string>();
    }
    double number(const char* name) const { return number(at(name), name); }
    double number(const Json& value, const std::string& name) const {
        if (value.is_null()) return Metric::missing;
        if (!value.is_number()) fail("this must be a number or null", name);
        return value.get<double>();
    }
    const Json& list(const char* name) const {
        if (!at(name).is_array()) fail("this must be a list", name);
        return at(name);
    }
    const Json& value() const { return value_; }

  private:
    std::string key(const std::string& name) const {
        return name.empty() ? key_ : key_.empty() ? name : key_ + "." + name;
    }

    const Json& value_;
    std::string path_, key_;
};

MetricDirection direction(const Member& row) {
    const std::string name = row.text("direction");
    for (size_t k = 0; k < direction_names.size(); ++k)
        if (name == direction_names[k]) return static_cast<MetricDirection>(k);
    row.fail("this must be \"lower\", \"higher\" or \"none\", and is \"" + name + "\"", "direction");
}

int sample_count(const Member& row) {
    const Json& value = row.at("samples");
    if (!value.is_number_integer() || value.get<std::int64_t>() < 0 ||
        value.get<std::int64_t>() > std::numeric_limits<int>::max())
        row.fail("this must be a whole number, 0 or more", "samples");
    return value.get<int>();
}

Metric read_metric(const Member& row) {
    row.only({"metric", "value", "interval", "unit", "direction", "tolerance", "samples", "distribution", "floor"});
    Metric metric;
    metric.name = row.text("metric");
    if (metric.name.empty()) row.fail("this is empty", "metric");
    metric.value = row.number("value");
    const Json& interval = row.list("interval");
    if (interval.size() != 2) row.fail("this must be a list of two numbers", "interval");
    metric.low = row.number(interval[0], "interval");
    metric.high = row.number(interval[1], "interval");
    if (metric.low > metric.high) row.fail("the interval ends before it begins", "interval");
    metric.unit = row.text("unit");
    metric.direction = direction(row);
    metric.tolerance = row.number("tolerance");
    if (!(metric.tolerance >= 0.0)) row.fail("this must be 0 or more", "tolerance");
    metric.samples = sample_count(row);
    if (row.has("distribution")) {
        const Member spread = row.member("distribution");
        spread.only({"median", "p95", "p99", "largest"});
        metric.distribution = {spread.number("median"), spread.number("p95"), spread.number("p99"),
                               spread.number("largest")};
    }
    if (row.has("floor")) metric.floor = row.number("floor");
    return metric;
}

void check_version(const Member& root, const std::string& path) {
    if (root.text("format") != format_name) root.fail("this is no file of metrics", "format");
    const Json& version = root.at("version");
    if (!version.is_number_integer()) root.fail("this must be a whole number", "version");
    if (version != format_version)
        throw Error("this file of metrics is of version " + version.dump() + "; this program reads version " +
                        std::to_string(format_version),
                    path + ":version", "make it anew with this version of toile, from the same data");
}

/// Throws Error where two names are the same.
void check_unique(const MetricFile& file, const std::string& where) {
    std::unordered_set<std::string> metrics, lines;
    for (const Metric& metric : file.metric)
        if (!metrics.insert(metric.name).second) throw Error("a metric is there twice: " + metric.name, where);
    for (const MetricFile::Line& line : file.about)
        if (!lines.insert(line.name).second) throw Error("a name is there twice: " + line.name, where);
}

Json read_document(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) throw Error("there is no such file", path);
    std::ifstream in(path);
    if (!in) throw Error("the file cannot be read", path);
    try {
        return Json::parse(in);
    } catch (const Json::exception& error) {
        throw Error(std::string("not valid JSON: ") + error.what(), path,
                    "let this program's `toile evaluate` write it anew");
    }
}

/// File names may be no UTF-8: what is not becomes a question mark in a diamond.
std::string text_of(const Json& document) {
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

const char* direction_name(MetricDirection direction) {
    return direction_names.at(static_cast<size_t>(direction));
}

Json metric_document(const MetricFile& file) {
    check_unique(file, file.kind);
    Json about = Json::object(), rows = Json::array();
    for (const MetricFile::Line& line : file.about) about[line.name] = line.value;
    for (const Metric& metric : file.metric) rows.push_back(as_json(metric));
    return {{"format", format_name}, {"version", format_version},
            {"kind", file.kind},     {"program_version", TOILE_VERSION},
            {"about", about},        {"metric", rows}};
}

void write_metric_file(const std::string& path, const MetricFile& file) {
    write_metric_file(path, file, Json::object());
}

void write_metric_file(const std::string& path, const MetricFile& file, const Json& own) {
    Json document = metric_document(file);
    for (const auto& item : own.items()) {
        if (document.contains(item.key())) throw Error("a member of every kind's: " + item.key(), path);
        document[item.key()] = item.value();
    }
    write_text_file(path, text_of(document));
}

std::string metric_text(const MetricFile& file) {
    return text_of(metric_document(file));
}

MetricFile as_metric_file(const Json& document, const std::string& path, const std::string& kind) {
    const Member root(document, path, "");
    check_version(root, path);
    MetricFile file;
    file.kind = root.text("kind");
    if (!kind.empty() && file.kind != kind)
        root.fail("this must be \"" + kind + "\", and is \"" + file.kind + "\"", "kind");
    file.program_version = root.text("program_version");
    const Member about = root.member("about");
    for (const auto& item : about.value().items()) file.about.push_back({item.key(), about.text(item.key().c_str())});
    size_t index = 0;
    for (const Json& row : root.list("metric"))
        file.metric.push_back(read_metric(Member(row, path, "metric[" + std::to_string(index++) + "]")));
    check_unique(file, path);
    return file;
}

MetricFile read_metric_file(const std::string& path, const std::string& kind) {
    return as_metric_file(read_document(path), path, kind);
}

Json read_metric_document(const std::string& path, const std::string& kind) {
    Json document = read_document(path);
    as_metric_file(document, path, kind);
    return document;
}

}  // namespace toile::files
