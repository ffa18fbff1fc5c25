#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/config_document.h"
#include "files/config_file.h"
#include "files/digest.h"

namespace toile::files {

namespace fs = std::filesystem;
using detail::ConfigDocument;
using detail::number_text;
using detail::quote;
using detail::show;

namespace {

std::string bound_text(double value) {
    const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
    return whole ? std::to_string(static_cast<std::int64_t>(value)) : number_text(value);
}

/// "1.2 to 2.2", "above 0", "at least 0", "at most 1" or nothing.
std::string bounds_text(const ConfigField& field) {
    const bool lower = std::isfinite(field.lower), upper = std::isfinite(field.upper);
    if (lower && upper)
        return (field.above ? "above " : "") + bound_text(field.lower) + (field.above ? " up to " : " to ") +
               bound_text(field.upper);
    if (lower) return (field.above ? "above " : "at least ") + bound_text(field.lower);
    if (upper) return "at most " + bound_text(field.upper);
    return {};
}

std::string with_unit(const ConfigField& field) {
    std::string text = bounds_text(field);
    if (!field.unit.empty()) text += (text.empty() ? "[" : " [") + std::string(field.unit) + "]";
    return text;
}

std::string expected(const std::string& kind, const ConfigField& field) {
    const std::string bounds = with_unit(field);
    return bounds.empty() ? kind : kind + " (" + bounds + ")";
}

bool inside(double value, const ConfigField& field) {
    const bool above_lower = field.above ? value > field.lower : value >= field.lower;
    return std::isfinite(value) && above_lower && value <= field.upper;
}

std::string list_text(const std::vector<std::string>& word, const char* separator) {
    std::string text;
    for (const std::string& one : word) text += (text.empty() ? "" : separator) + one;
    return text;
}

template <class Range, class Print>
std::string array_text(const Range& range, const Print& print) {
    std::vector<std::string> part;
    for (const auto& one : range) part.push_back(print(one));
    return "[" + list_text(part, ", ") + "]";
}

/// A number, written as an integer or as a float.
std::optional<double> as_real(const toml::node& node) {
    if (const auto* value = node.as_floating_point()) return value->get();
    if (const auto* value = node.as_integer()) return static_cast<double>(value->get());
    return std::nullopt;
}

}  // namespace

ConfigTable::ConfigTable(std::shared_ptr<ConfigDocument> document, std::string path)
    : document_(std::move(document)), path_(std::move(path)) {}

namespace {

/// The node of a key, which from now on is known; null where it is absent.
const toml::node* take(ConfigDocument& document, const std::string& path, std::string_view key) {
    document.known[path].emplace_back(key);
    const toml::node* table = document.find(path);
    return table && table->is_table() ? table->as_table()->get(key) : nullptr;
}

}  // namespace

std::optional<ConfigTable> ConfigTable::table(std::string_view name, std::string_view doc) {
    if (has(name)) return section(name, doc);
    take(*document_, path_, name);
    return std::nullopt;
}

ConfigTable ConfigTable::section(std::string_view name, std::string_view doc) {
    const toml::node* node = take(*document_, path_, name);
    if (node && !node->is_table()) fail(name, "is " + show(*node) + ", a table is expected");
    const std::string path = detail::join(path_, name);
    document_->section_of(path).doc = doc;
    return ConfigTable(document_, path);
}

void ConfigTable::real(std::string_view key, double& value, const ConfigField& field) {
    std::optional<double> resolved = value;
    real(key, resolved, field);
    value = *resolved;
}

void ConfigTable::real(std::string_view key, std::optional<double>& value, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const std::optional<double> given = as_real(*node);
        if (!given || !inside(*given, field))
            fail(key, "is " + show(*node) + ", allowed is " + expected("a number", field));
        value = given;
    }
    record(key, value ? number_text(*value) : std::string(), with_unit(field), field.doc);
}

void ConfigTable::integer(std::string_view key, int& value, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const auto* given = node->as_integer();
        if (!given || !inside(static_cast<double>(given->get()), field) ||
            given->get() != static_cast<int>(given->get()))
            fail(key, "is " + show(*node) + ", allowed is " + expected("a whole number", field));
        value = static_cast<int>(given->get());
    }
    record(key, std::to_string(value), with_unit(field), field.doc);
}

void ConfigTable::integer_or(std::string_view key, std::optional<int>& value, std::string_view word,
                             const ConfigField& field) {
    const std::string about = with_unit(field) + ", or " + quote(word);
    const toml::node* node = take(*document_, path_, key);
    if (node && node->is_string() && node->as_string()->get() == word) {
        value.reset();
    } else if (node) {
        const auto* given = node->as_integer();
        if (!given || !inside(static_cast<double>(given->get()), field) ||
            given->get() != static_cast<int>(given->get()))
            fail(key, "is " + show(*node) + ", allowed is " + expected("a whole number", field) + " or " + quote(word));
        value = static_cast<int>(given->get());
    }
    record(key, value ? std::to_string(*value) : quote(word), about, field.doc);
}

void ConfigTable::seed(std::string_view key, std::uint64_t& value, std::string_view doc) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const auto* given = node->as_integer();
        if (!given || given->get() < 0) fail(key, "is " + show(*node) + ", allowed is a whole number (at least 0)");
        value = static_cast<std::uint64_t>(given->get());
    }
    record(key, std::to_string(value), "at least 0", doc);
}

void ConfigTable::boolean(std::string_view key, bool& value, std::string_view doc) {
    if (const toml::node* node = take(*document_, path_, key)) {
        if (!node->is_boolean()) fail(key, "is " + show(*node) + ", allowed is true or false");
        value = node->as_boolean()->get();
    }
    record(key, value ? "true" : "false", "true or false", doc);
}

void ConfigTable::text(std::string_view key, std::string& value, std::string_view doc) {
    if (const toml::node* node = take(*document_, path_, key)) {
        if (!node->is_string()) fail(key, "is " + show(*node) + ", allowed is a text in quotes");
        value = node->as_string()->get();
    }
    record(key, quote(value), {}, doc);
}

void ConfigTable::path(std::string_view key, ConfigPath& value, std::string_view doc) {
    const toml::node* node = take(*document_, path_, key);
    if (!node) {
        record(key, {}, "a file", doc);
        return;
    }
    if (!node->is_string() || node->as_string()->get().empty())
        fail(key, "is " + show(*node) + ", allowed is the path of a file");
    value.written = node->as_string()->get();
    const bool overridden = node->source().path && *node->source().path != document_->file;
    std::error_code failure;
    if (overridden) value.written = fs::absolute(value.written, failure).lexically_normal().string();
    value.resolved = fs::absolute(fs::path(document_->folder) / value.written, failure).lexically_normal().string();
    if (!fs::exists(value.resolved, failure)) fail(key, "names a file that is not there: " + quote(value.resolved));
    if (!fs::is_regular_file(value.resolved, failure)) fail(key, "is not a file: " + quote(value.resolved));
    const std::optional<std::string> digest = file_digest(value.resolved);
    if (!digest) fail(key, "names a file that cannot be read: " + quote(value.resolved));
    record(key, quote(value.written), "a file", doc);
    detail::ConfigEntry& entry = document_->section_of(path_).entry.back();
    entry.absolute = quote(value.resolved);
    entry.digest = quote("xxh3-128:" + *digest);
}

void ConfigTable::vector(std::string_view key, Eigen::Vector3d& value, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const toml::array* array = node->as_array();
        bool good = array && array->size() == 3;
        for (int axis = 0; good && axis < 3; ++axis) {
            const std::optional<double> given = as_real(*array->get(static_cast<size_t>(axis)));
            good = given && inside(*given, field);
            if (good) value[axis] = *given;
        }
        if (!good) fail(key, "is " + show(*node) + ", allowed is " + expected("three numbers [x, y, z]", field));
    }
    record(key, array_text(value, number_text), with_unit(field), field.doc);
}

void ConfigTable::interval(std::string_view key, double& lower, double& upper, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const toml::array* array = node->as_array();
        std::optional<double> low, high;
        if (array && array->size() == 2) {
            low = as_real(*array->get(0));
            high = as_real(*array->get(1));
        }
        if (!low || !high || !inside(*low, field) || !inside(*high, field))
            fail(key, "is " + show(*node) + ", allowed is " + expected("two numbers [lower, upper]", field));
        if (*low > *high)
            fail(key, "is " + show(*node) + ": the lower limit is above the upper one",
                 "write the smaller number first");
        lower = *low;
        upper = *high;
    }
    record(key, "[" + number_text(lower) + ", " + number_text(upper) + "]", with_unit(field), field.doc);
}

void ConfigTable::integers(std::string_view key, std::vector<int>& value, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const toml::array* array = node->as_array();
        std::vector<int> given;
        for (size_t i = 0; array && i < array->size(); ++i) {
            const auto* one = array->get(i)->as_integer();
            if (one && inside(static_cast<double>(one->get()), field) && one->get() == static_cast<int>(one->get()))
                given.push_back(static_cast<int>(one->get()));
        }
        if (!array || given.size() != array->size())
            fail(key, "is " + show(*node) + ", allowed is " + expected("a list of whole numbers", field));
        value = given;
    }
    record(key, array_text(value, [](int one) { return std::to_string(one); }), with_unit(field), field.doc);
}

void ConfigTable::reals(std::string_view key, std::vector<double>& value, const ConfigField& field) {
    if (const toml::node* node = take(*document_, path_, key)) {
        const toml::array* array = node->as_array();
        std::vector<double> given;
        for (size_t i = 0; array && i < array->size(); ++i)
            if (const std::optional<double> one = as_real(*array->get(i)); one && inside(*one, field))
                given.push_back(*one);
        if (!array || given.size() != array->size())
            fail(key, "is " + show(*node) + ", allowed is " + expected("a list of numbers", field));
        value = given;
    }
    record(key, array_text(value, number_text), with_unit(field), field.doc);
}

void ConfigTable::choices(std::string_view key, std::vector<std::string>& value,
                          const std::vector<std::string>& allowed, std::string_view doc) {
    const std::string words = list_text(allowed, ", ");
    std::vector<std::string> given = value;
    texts_of(key, given);
    for (const std::string& one : given)
        if (std::find(allowed.begin(), allowed.end(), one) == allowed.end())
            fail(key, "has " + quote(one) + ", allowed are some of: " + words);
    value = given;
    record(key, array_text(value, [](const std::string& one) { return quote(one); }), "some of: " + words, doc);
}

void ConfigTable::texts_of(std::string_view key, std::vector<std::string>& value) {
    const toml::node* node = take(*document_, path_, key);
    if (!node) return;
    const toml::array* array = node->as_array();
    std::vector<std::string> given;
    for (size_t i = 0; array && i < array->size(); ++i)
        if (const auto* one = array->get(i)->as_string()) given.push_back(one->get());
    if (!array || given.size() != array->size()) fail(key, "is " + show(*node) + ", allowed is a list of texts");
    value = given;
}

void ConfigTable::texts(std::string_view key, std::vector<std::string>& value, std::string_view doc) {
    texts_of(key, value);
    record(key, array_text(value, [](const std::string& one) { return quote(one); }), {}, doc);
}

size_t ConfigTable::choose(std::string_view key, const std::string& value, const std::vector<std::string>& allowed,
                           std::string_view doc) {
    size_t index = allowed.size();
    const std::string words = list_text(allowed, ", ");
    if (const toml::node* node = take(*document_, path_, key)) {
        const auto* given = node->as_string();
        for (size_t i = 0; given && i < allowed.size(); ++i)
            if (given->get() == allowed[i]) index = i;
        if (index == allowed.size()) fail(key, "is " + show(*node) + ", allowed is one of: " + words);
    }
    record(key, quote(index < allowed.size() ? allowed[index] : value), "one of: " + words, doc);
    return index;
}

std::vector<std::string> ConfigTable::keys() const {
    std::vector<std::string> name;
    const toml::node* node = document_->find(path_);
    if (node && node->is_table())
        for (const auto& [key, value] : *node->as_table()) name.emplace_back(key.str());
    return name;
}

bool ConfigTable::has(std::string_view key) const {
    const toml::node* node = document_->find(path_);
    return node && node->is_table() && node->as_table()->contains(key);
}

std::string ConfigTable::where(std::string_view key) const {
    const toml::node* table = document_->find(path_);
    const toml::node* node = !key.empty() && table && table->is_table() ? table->as_table()->get(key) : nullptr;
    return document_->where(node ? node : table);
}

std::string ConfigTable::name(std::string_view key) const {
    return detail::join(path_, key);
}

void ConfigTable::fail(std::string_view key, const std::string& what, const std::string& mend) const {
    throw Error(name(key) + " " + what, where(key), mend);
}

void ConfigTable::record(std::string_view key, std::string value, std::string about, std::string_view doc) {
    document_->section_of(path_).entry.push_back(
        {std::string(key), std::move(value), {}, {}, std::move(about), std::string(doc)});
}

}  // namespace toile::files
